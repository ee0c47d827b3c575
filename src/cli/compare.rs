//! `warpfront compare`.

use std::fmt::Write;
use std::path::Path;

use serde::Serialize;

use super::args::CompareArgs;
use super::completion::Completion;
use super::failure::Failure;
use super::interrupt::Interrupt;
use super::outputs::same_file;
use super::say::{print, print_json, say};
use super::units::{plural, significant};
use crate::asset::Files;
use crate::film::atomic::Output;
use crate::film::{read_exr_with, write_exr, write_rgb8};
use crate::study::compare::{ChannelComparison, Comparison, DECADES, EPSILON, PicturePair, Verdict};
use crate::study::noise::{BLOCK, Deviation, Noise, SIGNIFICANCE};
use crate::study::window::Window;

/// Compares two pictures and writes their difference.
pub(super) fn run(args: &CompareArgs) -> Result<Completion, Failure> {
    // Without a render to keep, Ctrl-C ends the process and removes unfinished files.
    Interrupt::install();
    let open = |path: &Path| {
        spare_inputs(path, [&args.a, &args.b])?;
        Output::create(path).map_err(Failure::from)
    };
    let exr = args.output.as_deref().map(open).transpose()?;
    let png = args.png.as_deref().map(open).transpose()?;
    let files = Files::within(args.memory.memory());
    let (a, b) = (read_exr_with(&args.a, &files)?, read_exr_with(&args.b, &files)?);
    let [name_a, name_b] = [&args.a, &args.b].map(|path| path.display().to_string());
    let pair = PicturePair::new((&name_a, &a), (&name_b, &b))?;
    let report = ComparisonReport { a: &name_a, b: &name_b, epsilon: EPSILON, comparison: pair.compare() };

    if args.json {
        print_json(&report)?;
    } else {
        print(&report.text())?;
    }
    if let Some(exr) = exr {
        let mut difference = pair.difference();
        difference.attributes = vec![("difference".to_owned(), format!("{name_a} - {name_b}"))];
        let path = exr.path().display().to_string();
        exr.commit(|out| write_exr(&difference, out))?;
        say(format!("wrote {path}: A - B"));
    }
    if let Some(png) = png {
        let path = png.path().display().to_string();
        png.commit(|out| write_rgb8(&pair.false_color(), a.size, out))?;
        say(format!("wrote {path}: {}", scale()));
    }
    let excesses = excesses(args, &report.comparison);
    excesses.iter().for_each(|excess| say(format!("differ: {excess}")));
    Ok(if excesses.is_empty() { Completion::Good } else { Completion::Differ })
}

/// Refuses an output that would replace a picture to compare.
fn spare_inputs(output: &Path, inputs: [&Path; 2]) -> Result<(), Failure> {
    if inputs.into_iter().any(|input| same_file(output, input)) {
        let message = format!("`{}` is one of the pictures to compare", output.display());
        return Err(Failure::new(message).help("name another file for the difference"));
    }
    Ok(())
}

/// Quantity and colour scale of the PNG, in words.
fn scale() -> String {
    format!(
        "|A - B|/sqrt(B² + {EPSILON}), root mean square of R, G, B; logarithmic, {} and below black, \
         1 and above pale yellow; green is not finite",
        libm::pow(10f64, -DECADES)
    )
}

/// Excesses over the bounds that were given, one line each.
fn excesses(args: &CompareArgs, comparison: &Comparison) -> Vec<String> {
    let Comparison { beauty, verdict, .. } = comparison;
    let mut excesses = Vec::new();
    let measures = beauty.measures.as_ref();
    let bounds = [
        ("RMSE", measures.map(|m| m.rmse), "--max-rmse", args.max_rmse),
        ("relMSE", measures.map(|m| m.relmse), "--max-relmse", args.max_relmse),
    ];
    for (what, found, flag, bound) in bounds {
        if let (Some(found), Some(bound)) = (found, bound)
            && found > bound
        {
            excesses.push(format!("{what} {} is above {flag} {bound}", significant(found)));
        }
    }
    let bounded = args.max_rmse.is_some() || args.max_relmse.is_some();
    if bounded && beauty.non_finite_unequal > 0 {
        excesses.push(format!("{} unequal pairs of colours that are not finite", beauty.non_finite_unequal));
    }
    if args.strict && !matches!(verdict, Verdict::Identical | Verdict::WithinNoise) {
        excesses.push("not the same within noise, as --strict asks".to_owned());
    }
    excesses
}

/// Report to print.
#[derive(Serialize)]
struct ComparisonReport<'a> {
    a: &'a str,
    b: &'a str,
    /// Of relMSE.
    epsilon: f64,
    #[serde(flatten)]
    comparison: Comparison,
}

impl ComparisonReport<'_> {
    fn text(&self) -> String {
        let Comparison { window, beauty, channels, only_a, only_b, noise, verdict } = &self.comparison;
        let mut text = format!(
            "A            {}\nB            {} (reference)\npixels       {}\n\n",
            self.a,
            self.b,
            place(window)
        );
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:<12} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}  {:<12} unequal",
            "channel", "RMSE", "relMSE", "mean A", "mean B", "A/B - 1", "max A - B", "at"
        );
        let all: Vec<&ChannelComparison> = std::iter::once(beauty).chain(channels).collect();
        text.extend(all.iter().map(|channel| row(channel)));
        text.extend(all.iter().filter_map(|channel| left_out(channel)));
        for (names, side) in [(only_a, "A"), (only_b, "B")] {
            if !names.is_empty() {
                let _ = writeln!(text, "only in {side}    {}", names.join(", "));
            }
        }
        let _ =
            writeln!(text, "\n(relMSE: mean of (a - b)²/(b² + {EPSILON}); largest |A - B| with its sign)");
        if let Some(noise) = noise {
            text.push_str(&noise_text(noise));
        }
        text + &verdict_line(*verdict, beauty, noise.as_ref())
    }
}

fn row(channel: &ChannelComparison) -> String {
    let name = &channel.name;
    let Some(measures) = &channel.measures else {
        return format!("{name:<12} no finite values\n");
    };
    let [rmse, relmse, mean_a, mean_b, largest] =
        [measures.rmse, measures.relmse, measures.mean_a, measures.mean_b, measures.largest_difference]
            .map(significant);
    let means = measures.difference_of_means.map_or("-".to_owned(), |d| format!("{:+.3} %", 100.0 * d));
    let at = format!("{:?}", measures.largest_at);
    let unequal = 100.0 * channel.unequal as f64 / (channel.finite + channel.non_finite) as f64;
    format!(
        "{name:<12} {rmse:>10} {relmse:>10} {mean_a:>10} {mean_b:>10} {means:>10} {largest:>10}  {at:<12} \
         {unequal:.2} %\n"
    )
}

/// Pairs left out of the sums of a channel, in words.
fn left_out(channel: &ChannelComparison) -> Option<String> {
    let ChannelComparison { name, non_finite, non_finite_unequal, .. } = channel;
    (*non_finite > 0).then(|| {
        let pairs = plural(*non_finite, "pair is not finite", "pairs are not finite");
        format!("left out     {name}: {pairs}, {non_finite_unequal} of them unequal\n")
    })
}

fn noise_text(noise: &Noise) -> String {
    let share = |count: usize| 100.0 * count as f64 / noise.pixels.tested.max(1) as f64;
    let means = noise.means.map(|z| z.map_or("-".to_owned(), |z| format!("{z:+.2}")));
    let mut text = format!(
        "\npixels, z    |z| > 2: {:.2} % (4.55 % of normal ones), |z| > 3: {:.2} % (0.27 %), {}\n\
         means, z     R {}, G {}, B {}\n\
         tests        {} ({} blocks of {BLOCK}x{BLOCK} or more and the whole, in R, G, B), {}; \
         by chance {}\n",
        share(noise.pixels.beyond_2),
        share(noise.pixels.beyond_3),
        largest(noise.pixels.largest.as_ref()),
        means[0],
        means[1],
        means[2],
        noise.tests,
        noise.blocks,
        largest(noise.largest.as_ref()),
        significant(noise.probability),
    );
    if noise.non_finite > 0 {
        let _ = writeln!(
            text,
            "left out     {} pairs from the tests: values or variances that are not finite",
            noise.non_finite
        );
    }
    if noise.same_seed && noise.largest.as_ref().is_some_and(|largest| largest.z != 0.0) {
        text.push_str(
            "note         both have the same seed: their noise may be the same and hide differences; \
             render one with another --seed\n",
        );
    }
    text
}

fn largest(deviation: Option<&Deviation>) -> String {
    deviation.map_or("nothing varies".to_owned(), |Deviation { z, channel, window }| {
        format!("largest {z:+.2} in {channel}, {}", place(window))
    })
}

fn place(window: &Window) -> String {
    let Window { origin, size } = window;
    match size {
        (1, 1) => format!("pixel {origin:?}"),
        (width, height) => format!("{width}x{height} at {origin:?}"),
    }
}

fn verdict_line(verdict: Verdict, beauty: &ChannelComparison, noise: Option<&Noise>) -> String {
    let why = match (verdict, noise) {
        (Verdict::Identical, _) => "identical: no value of R, G, B differs".to_owned(),
        (Verdict::Unjudged, _) => "differ; whether by more than noise only variances of both tell \
             (render with --aov variance and 2 samples per pixel or more)"
            .to_owned(),
        (Verdict::Differ, _) if beauty.non_finite_unequal > 0 => {
            "differ: values that are not finite are unequal".to_owned()
        }
        (Verdict::Differ, noise) => format!(
            "differ: so large a deviation comes by chance in {} of equal pictures, less than {SIGNIFICANCE}",
            significant(noise.map_or(0.0, |noise| noise.probability))
        ),
        (Verdict::WithinNoise, _) => "same within noise".to_owned(),
    };
    format!("verdict      {why}\n")
}
