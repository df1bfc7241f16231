//! Colours of the participant's page that must be told apart, for people with and without colour blindness.
//!
//! Colour vision deficiency is simulated with the matrices of Machado, Oliveira and Fernandes (2009), "A Physiologically-based Model
//! for Simulation of Color Vision Deficiency", severity 1.0, in linear RGB. Distances are CIE 1976 ones in L*a*b* (D65).

use crate::support::*;

type Matrix = [[f64; 3]; 3];

const SIGHTS: [(&str, Matrix); 4] = [
    ("normal sight", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
    ("protanopia", [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]),
    (
        "deuteranopia",
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    ),
    ("tritanopia", [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]]),
];

/// What two colours that must be told apart differ by at least, for every sight: distance in L*a*b*, and lightness alone.
const LEAST_DISTANCE: f64 = 15.0;
const LEAST_LIGHTNESS: f64 = 14.0;

fn times(matrix: &Matrix, [x, y, z]: [f64; 3]) -> [f64; 3] {
    matrix.map(|[a, b, c]| a * x + b * y + c * z)
}

/// L*a*b* of an sRGB colour such as "#c2187a", as somebody with this sight sees it.
fn lab(colour: &str, sight: &Matrix) -> [f64; 3] {
    const XYZ: Matrix =
        [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]];
    let linear = [1, 3, 5].map(|at| {
        let value = f64::from(u8::from_str_radix(&colour[at..at + 2], 16).expect("a colour of six digits")) / 255.0;
        if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    });
    let [x, y, z] = times(&XYZ, times(sight, linear).map(|value| value.clamp(0.0, 1.0)));
    let curve = |t: f64| {
        if t > (6.0_f64 / 29.0).powi(3) { t.cbrt() } else { t / (3.0 * (6.0_f64 / 29.0).powi(2)) + 4.0 / 29.0 }
    };
    let [fx, fy, fz] = [curve(x / 0.95047), curve(y), curve(z / 1.08883)];
    [116.0 * fy - 16.0, 500.0 * (fx - fy), 200.0 * (fy - fz)]
}

fn check(one: (&str, &str), other: (&str, &str)) {
    for (name, sight) in &SIGHTS {
        let (a, b) = (lab(one.1, sight), lab(other.1, sight));
        let distance = (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt();
        let lightness = (a[0] - b[0]).abs();
        assert!(
            distance >= LEAST_DISTANCE && lightness >= LEAST_LIGHTNESS,
            "{} ({}) and {} ({}) under {name}: distance {distance:.1}, lightness {lightness:.1}",
            one.0,
            one.1,
            other.0,
            other.1
        );
    }
}

fn read(path: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).expect("a file of the project")
}

#[test]
fn signals_and_the_two_rings_of_a_press_are_told_apart() {
    let css = read("src/devices/display/page/display.css");
    let colour = |name: &str| {
        let (_, after) = css.split_once(&format!("{name}: #")).unwrap_or_else(|| panic!("display.css has no {name}"));
        format!("#{}", &after[..6])
    };
    let [signal, works, fails] = ["--signal", "--works", "--fails"].map(colour);
    check(("signal", &signal), ("no effect", &fails));
    check(("signal", &signal), ("effect", &works));
    check(("effect", &works), ("no effect", &fails));
}

/// Contents of the same shape differ in colour alone.
#[test]
fn contents_of_one_shape_are_told_apart() {
    for file in ["recipes/sushi.toml", "recipes/burger.toml"] {
        let looks = read(file);
        let looks: Vec<(&str, &str)> = looks
            .lines()
            .filter_map(|line| line.strip_prefix("look = ["))
            .flat_map(|line| line.split('"').filter(|look| look.contains('#')))
            .filter_map(|look| look.split_once(' '))
            .map(|(shape, colours)| (shape, &colours[..7]))
            .collect();
        assert!(looks.len() > 8, "{file} has looks");
        for (index, one) in looks.iter().enumerate() {
            for other in looks[index + 1..].iter().filter(|other| other.0 == one.0) {
                check(*one, *other);
            }
        }
    }
}
