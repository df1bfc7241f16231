//! Chart of the ratios of rates (of the primary outcome) between study arms.

use maud::Markup;

use super::arm_comparison::StudyArmContrast;
use super::svg::{PlotAxis, SvgChart};

/// Largest ratio that is drawn to scale; longer intervals end at the border of the chart.
const LARGEST: f64 = 4.0;

/// Chart of ratios of rates with their confidence intervals; a line marks equal rates.
pub fn ratios(contrasts: &[StudyArmContrast]) -> Option<Markup> {
    if contrasts.is_empty() {
        return None;
    }
    let names: Vec<String> =
        contrasts.iter().map(|one| format!("{}\nto {}", one.arm.title(), one.against.title())).collect();
    let ends = contrasts.iter().flat_map(|one| one.interval).map(|end| end.min(LARGEST));
    let width = 160.0 + 110.0 * contrasts.len() as f64;
    let mut chart =
        SvgChart::new(width, 320.0, PlotAxis::named(&names), PlotAxis::over("ratio of rates", ends.chain([1.0])));
    chart.line("thin", &[(-0.5, 1.0), (contrasts.len() as f64 - 0.5, 1.0)]);
    for (x, one) in contrasts.iter().enumerate() {
        let x = x as f64;
        let [low, high] = one.interval.map(|end| end.min(LARGEST));
        chart.line("mean", &[(x, low), (x, high)]);
        let title = format!("{} to {}: {:.2}", one.arm.title(), one.against.title(), one.ratio);
        chart.point("assisted", x, one.ratio.min(LARGEST), &title);
        chart.words("strong", x + 0.06, one.ratio.min(LARGEST), true, &format!("{:.2}", one.ratio));
    }
    Some(chart.finish("Ratio of rates between conditions, with intervals of 95 %"))
}
