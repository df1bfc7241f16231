//! SVG charts: axes with round ticks, points, lines, bands, bars. CSS classes in the page's style sheet set the colours
//! for light and dark screens and for print.

use std::fmt::Write;

use maud::{Markup, PreEscaped, html};

/// Margins around the plot area of a chart, in pixels: left, right, top, bottom.
const MARGIN: [f64; 4] = [54.0, 14.0, 14.0, 44.0];

/// Axis of a chart: label, range and ticks.
#[derive(Clone, Debug)]
pub struct PlotAxis {
    pub label: &'static str,
    pub from: f64,
    pub to: f64,
    /// Ticks of the axis: position and label.
    pub ticks: Vec<(f64, String)>,
}

impl PlotAxis {
    /// Axis whose range includes these values and 0, with ticks at round numbers.
    pub fn over(label: &'static str, values: impl Iterator<Item = f64>) -> PlotAxis {
        let (low, high) = values
            .filter(|value| value.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        let (low, high) = if low > high { (0.0, 1.0) } else { (low.min(0.0), high.max(0.0)) };
        PlotAxis::between(label, low, if high > low { high } else { low + 1.0 })
    }

    pub fn between(label: &'static str, low: f64, high: f64) -> PlotAxis {
        let step = round_step((high - low) / 5.0);
        let (first, last) = ((low / step).floor() as i64, (high / step - 1e-9).ceil() as i64);
        let digits = digits(step);
        let tick = |number: i64| (number as f64 * step, minus(&format!("{:.digits$}", number as f64 * step)));
        PlotAxis { label, from: first as f64 * step, to: last as f64 * step, ticks: (first..=last).map(tick).collect() }
    }

    /// Axis of categories; the first category is at position 0, the next at 1.
    pub fn named(names: &[String]) -> PlotAxis {
        let ticks = names.iter().enumerate().map(|(index, name)| (index as f64, name.clone())).collect();
        PlotAxis { label: "", from: -0.5, to: names.len() as f64 - 0.5, ticks }
    }
}

/// The smallest of 1, 2, 2.5 and 5 times a power of ten that is at least `step`.
fn round_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    let factor = [1.0, 2.0, 2.5, 5.0].into_iter().find(|factor| factor * power >= step * (1.0 - 1e-9));
    factor.unwrap_or(10.0) * power
}

/// Number of decimals that show an axis step and its multiples without rounding.
fn digits(step: f64) -> usize {
    let is_exact = |digits: &usize| {
        let scaled = step * 10f64.powi(*digits as i32);
        (scaled - scaled.round()).abs() < 1e-6 * scaled
    };
    (0..12).find(is_exact).unwrap_or(12)
}

#[derive(Clone, Debug)]
pub struct SvgChart {
    width: f64,
    height: f64,
    x: PlotAxis,
    y: PlotAxis,
    body: String,
}

impl SvgChart {
    /// Creates a chart of this size in pixels, with axes and grid lines.
    pub fn new(width: f64, height: f64, x: PlotAxis, y: PlotAxis) -> SvgChart {
        let mut chart = SvgChart { width, height, x, y, body: String::new() };
        chart.frame();
        chart
    }

    fn px(&self, x: f64) -> f64 {
        let [left, right, ..] = MARGIN;
        left + (x - self.x.from) / (self.x.to - self.x.from) * (self.width - left - right)
    }

    fn py(&self, y: f64) -> f64 {
        let [.., top, bottom] = MARGIN;
        self.height - bottom - (y - self.y.from) / (self.y.to - self.y.from) * (self.height - top - bottom)
    }

    fn add(&mut self, element: Markup) {
        self.body.push_str(&element.0);
        self.body.push('\n');
    }

    fn frame(&mut self) {
        let [left, right, top, bottom] = MARGIN;
        let (width, height) = (self.width, self.height);
        for (value, text) in self.y.ticks.clone() {
            let y = self.py(value);
            let class = if value == 0.0 { "axis" } else { "grid" };
            let path = format!("M{left:.1} {y:.1}H{:.1}", width - right);
            self.add(html! { path class=(class) d=(path) {} });
            self.add(html! { text class="tick end" x=(tenths(left - 7.0)) y=(tenths(y + 4.0)) { (text) } });
        }
        let base = height - bottom;
        let path = format!("M{left:.1} {top:.1}V{base:.1}H{:.1}", width - right);
        self.add(html! { path class="axis" d=(path) {} });
        for (value, text) in self.x.ticks.clone() {
            let x = self.px(value);
            self.add(html! { path class="axis" d=(format!("M{x:.1} {base:.1}v4")) {} });
            for (line, part) in text.split('\n').enumerate() {
                let y = base + 17.0 + 13.0 * line as f64;
                self.add(html! { text class="tick middle" x=(tenths(x)) y=(tenths(y)) { (part) } });
            }
        }
        let (x, y) = ((left + width - right) / 2.0, height - 8.0);
        self.add(html! { text class="label middle" x=(tenths(x)) y=(tenths(y)) { (self.x.label) } });
        let turned = format!("translate(13 {:.1}) rotate(-90)", (top + base) / 2.0);
        self.add(html! { text class="label middle" transform=(turned) { (self.y.label) } });
    }

    pub fn point(&mut self, class: &str, x: f64, y: f64, title: &str) {
        let (x, y) = (tenths(self.px(x)), tenths(self.py(y)));
        self.add(html! { circle class=(class) cx=(x) cy=(y) r="4" { title { (title) } } });
    }

    pub fn line(&mut self, class: &str, points: &[(f64, f64)]) {
        let path = self.path(points);
        self.add(html! { path class={ "line " (class) } d=(path) {} });
    }

    /// Adds a band to the chart: each element holds x, lower height and upper height.
    pub(crate) fn band(&mut self, class: &str, band: &[[f64; 3]]) {
        if band.is_empty() {
            return;
        }
        let there = band.iter().map(|&[x, _, high]| (x, high));
        let back = band.iter().rev().map(|&[x, low, _]| (x, low));
        let path = self.path(&there.chain(back).collect::<Vec<_>>());
        self.add(html! { path class={ "band " (class) } d={ (path) "Z" } {} });
    }

    /// Adds a bar from 0 to y to the chart, between two positions on the x axis.
    pub fn bar(&mut self, class: &str, [from, to]: [f64; 2], y: f64, title: &str) {
        let (x, right, base, top) = (self.px(from), self.px(to), self.py(0.0), self.py(y));
        let [x, y, width, height] = [x, top, right - x, base - top].map(tenths);
        self.add(html! { rect class=(class) x=(x) y=(y) width=(width) height=(height) { title { (title) } } });
    }

    pub fn words(&mut self, class: &str, x: f64, y: f64, right: bool, text: &str) {
        let (x, y) = (self.px(x) + if right { 9.0 } else { -9.0 }, self.py(y) + 4.0);
        let side = if right { "start" } else { "end" };
        self.add(html! { text class={ "words " (side) " " (class) } x=(tenths(x)) y=(tenths(y)) { (text) } });
    }

    fn path(&self, points: &[(f64, f64)]) -> String {
        let mut path = String::new();
        for (index, &(x, y)) in points.iter().enumerate() {
            let _ = write!(path, "{}{:.1} {:.1}", if index == 0 { "M" } else { "L" }, self.px(x), self.py(y));
        }
        path
    }

    pub fn finish(self, title: &str) -> Markup {
        let size = format!("0 0 {:.0} {:.0}", self.width, self.height);
        html! { svg viewBox=(size) role="img" aria-label=(title) { "\n" (PreEscaped(self.body)) } "\n" }
    }
}

pub fn document(chart: &Markup, style: &str) -> String {
    let style = format!("<style>\n{style}svg {{ background: var(--paper); }}\n</style>\n");
    let chart = chart.0.replacen("<svg ", "<svg xmlns=\"http://www.w3.org/2000/svg\" ", 1);
    match chart.split_once('\n') {
        Some((head, body)) => format!("{head}\n{style}{body}"),
        None => chart,
    }
}

/// A coordinate in pixels as text with one decimal.
fn tenths(pixels: f64) -> String {
    format!("{pixels:.1}")
}

/// Replaces hyphens in numbers by minus signs.
pub fn minus(text: &str) -> String {
    text.replace('-', "\u{2212}")
}
