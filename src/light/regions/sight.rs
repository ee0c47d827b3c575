//! Sight of a place around a spinning hole, by the table of orbits.

use glam::DVec3;

use crate::geodesic::kerr::{OrbitTable, PlaneRay, TablePlace, turned, with_own_turn};

/// Ray along which a place is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// Unit direction at its start, in the frame at rest.
    pub direction: DVec3,
    /// Unit vector across the plane of the orbit at its end.
    pub across: DVec3,
    /// Angle that the orbit sweeps, radians.
    pub angle: f64,
    /// Winding about the axis, radians.
    turn: f64,
    /// How often it winds about the centre.
    winding: u32,
}

impl Sight {
    /// The ray to a place with this winding number; its winding about the axis is known within `tolerance`, radians.
    pub fn of(
        table: &OrbitTable,
        [from, to]: [&TablePlace; 2],
        winding: u32,
        tolerance: f64,
    ) -> Option<Self> {
        let guess = to.chart_turn - from.chart_turn;
        let (ray, turn) = with_own_turn(guess, tolerance, |turn, _: Option<&PlaneRay>| {
            let ray = table.ray_to(from, to, winding, turn);
            Some((ray, ray.turn))
        })?;
        let PlaneRay { tangent, angle, alpha, .. } = ray;
        let direction = table.direction(from, tangent, alpha)?;
        let across = turned(from.place.n.cross(tangent), turn);
        Some(Self { direction, across, angle, turn, winding })
    }

    /// Direction in which another place beside that one is seen, by rays that wind about the axis as much but for the chart.
    pub fn beside(&self, table: &OrbitTable, [from, to, other]: [&TablePlace; 3]) -> Option<DVec3> {
        let turn = self.turn + other.chart_turn - to.chart_turn;
        let PlaneRay { tangent, alpha, .. } = table.ray_to(from, other, self.winding, turn);
        table.direction(from, tangent, alpha)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geodesic::kerr::{KerrPlace, UnitHole};

    /// Differences between directions of the table and solved ones, radians, sorted.
    fn differences(a: f64, winding: u32) -> Vec<f64> {
        let hole = UnitHole::new(a, 0.0);
        let table = OrbitTable::new(&hole);
        let mut state = 7u64;
        let mut number = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut place = || {
            let z = 2.0 * number() - 1.0;
            let n = turned(DVec3::new((1.0 - z * z).sqrt(), 0.0, z), std::f64::consts::TAU * number());
            KerrPlace { r: 3.0 * libm::pow(100.0, number()), n }
        };
        let difference = |(from, to): (KerrPlace, KerrPlace)| {
            let aim = from.aim(&hole, &to, winding)?;
            let [from, to] = [table.place(from)?, table.place(to)?];
            let sight = Sight::of(&table, [&from, &to], winding, 0.003)?;
            Some(sight.direction.distance(aim.shot.direction))
        };
        let pairs: Vec<_> = (0..1000).map(|_| (place(), place())).collect();
        let mut differences: Vec<f64> =
            pairs.into_iter().map(|pair| difference(pair).unwrap_or(f64::INFINITY)).collect();
        differences.sort_by(f64::total_cmp);
        differences
    }

    #[test]
    fn the_table_differs_from_solved_aims_by_no_more_than_regions_are_wider() {
        for a in [0.0, 0.5, -0.9, 0.998] {
            for winding in [0, 1] {
                let [median, p90, p99] = {
                    let differences = differences(a, winding);
                    [500, 900, 990].map(|i| differences[i])
                };
                println!(
                    "a = {a}, {winding}: median {median:.1e}, nine of ten {p90:.1e}, 99 of 100 {p99:.1e}"
                );
                let margin = 0.002 + 0.01 * a * a;
                assert!(median < 0.5 * margin && p90 < 2.0 * margin, "a = {a}, {winding}: {median}, {p90}");
            }
        }
    }
}
