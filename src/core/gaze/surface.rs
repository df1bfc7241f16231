//! Maps gaze from a surface that the eye tracker follows to the wall display.

/// Least area of a valid tracked surface, as a share of the display.
const LEAST_AREA: f64 = 1e-3;

/// The homography of a tracked surface to the wall display.
///
/// An eye tracker reports gaze in fractions of a surface that the tracker found by markers. The positions of the
/// surface's four corners on the display are known and determine the mapping (Heckbert 1989, section 2.2.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceHomography {
    /// Rows of the homography from the unit square, y down, to fractions of the display.
    rows: [[f64; 3]; 3],
}

impl SurfaceHomography {
    /// The homography of the surface with these corners in fractions of the display: top left, top right, bottom right,
    /// bottom left. `None` if the corners are not a convex quadrangle in this order.
    pub fn new(corners: [[f64; 2]; 4]) -> Option<SurfaceHomography> {
        let turn =
            |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
        let turns = (0..4).map(|i| turn(corners[i], corners[(i + 1) % 4], corners[(i + 2) % 4]));
        // The corners run clockwise, since y points down: every turn has a positive cross product.
        if !turns.into_iter().all(|turn| turn.is_finite() && turn > LEAST_AREA) {
            return None;
        }
        let [p0, p1, p2, p3] = corners;
        let sum = [p0[0] - p1[0] + p2[0] - p3[0], p0[1] - p1[1] + p2[1] - p3[1]];
        let (d1, d2) = ([p1[0] - p2[0], p1[1] - p2[1]], [p3[0] - p2[0], p3[1] - p2[1]]);
        let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
        let (g, h) = (cross(sum, d2) / cross(d1, d2), cross(d1, sum) / cross(d1, d2));
        let row = |axis: usize| {
            let (a, b) = (p1[axis] - p0[axis] + g * p1[axis], p3[axis] - p0[axis] + h * p3[axis]);
            [a, b, p0[axis]]
        };
        Some(SurfaceHomography { rows: [row(0), row(1), [g, h, 1.0]] })
    }

    /// The display point of a gaze position on the surface (`norm_pos` of Pupil: origin at the bottom left, y up). The
    /// point may lie outside of the display; `None` if the position is no number, or beyond the horizon of the surface.
    pub fn to_display(&self, norm_pos: [f64; 2]) -> Option<[f64; 2]> {
        let at = [norm_pos[0], 1.0 - norm_pos[1], 1.0];
        let [x, y, w] = self.rows.map(|row| row.iter().zip(at).map(|(a, b)| a * b).sum::<f64>());
        let point = [x / w, y / w];
        (w > 0.0 && point.iter().all(|value| value.is_finite())).then_some(point)
    }
}
