//! `warpfront study --rays`.

use std::path::Path;

use csv::ByteRecord;
use glam::DVec3;
use rayon::prelude::*;

use super::args::StudyArgs;
use super::completion::Completion;
use super::failure::Failure;
use super::measure::{self, distinct_or};
use super::overwrite;
use super::prefixed::StudyFiles;
use super::progress::Meter;
use super::rays_table::RayColumns;
use super::shared_args::distinct;
use super::table::{InputTable, cell, line};
use super::units::plural;
use crate::study::free::{FreeRayEnd, SphereCrossing, TableForm};
use crate::study::table_rays::{Case, Exact, TableRays};
use crate::study::way::grid;

/// Tolerances, those on a scene and finer ones.
const TOLERANCES: [f64; 11] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12];
/// Columns of the table of rays that say how they end: status, position, direction, sensitivity.
type Ends = [&'static str; 8];

/// Studies the rays of a table.
pub(super) fn run(args: &StudyArgs, rays: &Path, files: StudyFiles) -> Result<Completion, Failure> {
    let form = TableForm::of(args.spacetime);
    for &stepper in &args.steppers {
        form.check(stepper)
            .map_err(|error| Failure::new(format!("--steppers: {}", error.cause)).help(error.remedy))?;
    }
    let steppers = distinct_or(&args.steppers, form.steppers);
    let tolerances = distinct_or(&args.tolerances, &TOLERANCES);
    let settings = grid(&steppers, &distinct(&args.precisions), &tolerances);
    measure::check_some(&settings)?;

    overwrite::refuse(files.paths(), &[rays.to_owned()])?;
    let mut table = InputTable::open(rays, "ray")?;
    let columns = RayColumns::find(&table.header, args.spacetime)?;
    let [x, y, z, dx, dy, dz, sens] = form.crossing;
    let names: Ends = ["status", x, y, z, dx, dy, dz, sens];
    let ends = columns.header.places(names)?.map(|places| (names, places));
    let (mut cases, mut lines) = (Vec::new(), Vec::new());
    loop {
        let rows = table.chunk()?;
        if rows.is_empty() {
            break;
        }
        let read: Result<Vec<Case>, Failure> = rows.par_iter().map(|row| case(&columns, ends, row)).collect();
        cases.extend(read?);
        lines.extend(rows.iter().map(line));
    }
    if cases.is_empty() {
        return Err(Failure::new(format!("`{}` has no rays", rays.display())).help("give a ray per row"));
    }

    let meter = Meter::new(args.meter.progress, "following rays", "runs");
    let measured = measure::run(TableRays::new(form, &cases, settings, args.threads), args.rounds, meter);
    let report = measured.map_err(|refusal| columns.header.refuse(lines[refusal.index], &refusal.fault))?;
    measure::publish(&report, files, &format!(" on {}", plural(cases.len(), "ray", "rays")))
}

/// The ray of a row and its end, which is in the columns `ends` or else followed.
fn case(columns: &RayColumns, ends: Option<(Ends, [usize; 8])>, row: &ByteRecord) -> Result<Case, Failure> {
    let form = columns.form;
    let (spacetime, ray) = columns.ray(row)?;
    let exact = match ends {
        Some(ends) => given(columns, ends, row)?,
        None => {
            let exact = Exact::followed(form, &spacetime, &ray)
                .map_err(|error| columns.header.refuse(line(row), &error))?;
            if exact.status.is_lost() {
                let cause = format!("the reference itself is lost: {}", exact.status.name());
                return Err(columns.header.at(line(row), "the ray", &cause).help("take the row out"));
            }
            exact
        }
    };
    Ok(Case { spacetime, ray, exact })
}

/// The end that the columns of a row give.
fn given(
    columns: &RayColumns,
    (names, places): (Ends, [usize; 8]),
    row: &ByteRecord,
) -> Result<Exact, Failure> {
    let text = String::from_utf8_lossy(cell(row, places[0]));
    let status = FreeRayEnd::ALL.into_iter().find(|status| status.name() == text && !status.is_lost());
    let status = status.ok_or_else(|| {
        columns
            .header
            .at(line(row), "column `status`", &format!("`{text}` is no end"))
            .help("give escaped, captured or missed")
    })?;
    if status != FreeRayEnd::Escaped {
        return Ok(Exact { status, crossing: None });
    }
    let mut numbers = [0.0; 8];
    for index in 1..numbers.len() {
        numbers[index] = columns.header.number(row, names[index], places[index])?;
    }
    let [_, x, y, z, dx, dy, dz, sens] = numbers;
    let (position, direction) = (DVec3::new(x, y, z), DVec3::new(dx, dy, dz));
    if sens <= 0.0 {
        let cause = format!("a sensitivity of {sens}");
        return Err(columns.header.at(line(row), "column `sens`", &cause).help("give a number above 0"));
    }
    let direction = direction.try_normalize().ok_or_else(|| {
        columns
            .header
            .at(line(row), &format!("columns `{}`, `{}`, `{}`", names[4], names[5], names[6]), "no direction")
            .help("give a direction of length 1")
    })?;
    Ok(Exact { status, crossing: Some(SphereCrossing { position, direction, sens }) })
}
