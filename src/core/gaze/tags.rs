//! How an eye tracker finds the wall display: by printed markers, AprilTags of the family tag36h11, one in each corner,
//! which give a surface whose gaze is mapped to the display.
//!
//! Pupil Labs asks for at least four tags with unique ids, a black edge of at least 8 cm at 2 m, and a white border of
//! one cell around each tag.

use crate::kitchen::{DisplayArea, IngredientStorage, Kitchen};

/// The AprilTag ids of the display's corners: top left, top right, bottom right, bottom left.
pub(crate) const IDS: [u16; 4] = [0, 1, 2, 3];
/// Smallest and largest edge of an AprilTag's black square, in millimetres; the largest edge that fits is used.
const EDGE_MM: (u32, u32) = (80, 100);
/// Number of cells along a side of an AprilTag's black square: six cells of data, and the black border.
const BLACK_CELLS: usize = 8;
/// Number of cells along a side of a whole AprilTag, with the white border.
pub const CELLS: usize = 10;
/// The data bits of the AprilTags with these ids: six rows of six bits, the first bit top left, 1 for white (Olson
/// 2011; Wang and Olson 2016).
const DATA: [u64; 4] = [0xd_5d62_8584, 0xd_97f1_8b49, 0xd_d280_910e, 0xe_479e_9c98];

/// An AprilTag on the wall display.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisplayTag {
    /// The tag's id in the family tag36h11.
    pub id: u16,
    /// The tag's area with its white border, in fractions of the display.
    pub area: DisplayArea,
    /// The area of the tag's black square, in fractions of the display.
    pub black: DisplayArea,
}

/// The AprilTags of a wall display, one in each corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisplayTags {
    /// The tags of the corners: top left, top right, bottom right, bottom left.
    pub corners: [DisplayTag; 4],
    /// Length of the edge of a tag's black square, in metres.
    pub edge_m: f64,
}

/// Error: AprilTags do not fit on a kitchen's wall display.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{found}")]
pub struct TagError {
    /// Which tag does not fit, and what is in its place.
    pub found: String,
    /// What would have to change so that the tag fits, in words.
    pub remedy: String,
}

impl DisplayTags {
    /// The largest AprilTags that fit into the corners of a kitchen's wall display beside locations and storages.
    ///
    /// # Errors
    /// A location or storage lies where the smallest tag would be.
    pub fn place(kitchen: &Kitchen) -> Result<DisplayTags, TagError> {
        let locations = kitchen.locations.iter().map(|location| (location.label(), location.display));
        let storage = |storage: &IngredientStorage| {
            (format!("{} of the {}", storage.label, storage.agent.name()), storage.display)
        };
        let taken: Vec<(String, DisplayArea)> = locations.chain(kitchen.storages.iter().map(storage)).collect();
        let in_the_way = |tags: &DisplayTags| {
            let hidden = |tag: &DisplayTag| {
                taken.iter().find(|(_, area)| overlap(tag.area, *area)).map(|(name, _)| name.clone())
            };
            let corners = ["top left", "top right", "bottom right", "bottom left"];
            tags.corners.iter().zip(corners).find_map(|(tag, corner)| Some((corner, hidden(tag)?)))
        };
        let (least, most) = EDGE_MM;
        let of_edge = |edge_mm: u32| DisplayTags::of_edge(f64::from(edge_mm) / 1000.0, kitchen.display_m);
        if let Some(tags) = (least..=most).rev().map(of_edge).find(|tags| in_the_way(tags).is_none()) {
            return Ok(tags);
        }
        let smallest = of_edge(least);
        let (corner, name) = in_the_way(&smallest).unwrap_or_default();
        let side_m = smallest.edge_m * CELLS as f64 / BLACK_CELLS as f64;
        Err(TagError {
            found: format!("\"{name}\" where the {corner} tag of the eye tracker has to be"),
            remedy: format!("{side_m:.2} m by {side_m:.2} m free in each corner of the display"),
        })
    }

    fn of_edge(edge_m: f64, display_m: [f64; 2]) -> DisplayTags {
        let cell_m = edge_m / BLACK_CELLS as f64;
        let [cell_x, cell_y] = display_m.map(|length_m| cell_m / length_m);
        let (w, h) = (cell_x * CELLS as f64, cell_y * CELLS as f64);
        let tag = |id: u16, x: f64, y: f64| {
            let (black_w, black_h) = (cell_x * BLACK_CELLS as f64, cell_y * BLACK_CELLS as f64);
            let black = DisplayArea { x: x + cell_x, y: y + cell_y, w: black_w, h: black_h };
            DisplayTag { id, area: DisplayArea { x, y, w, h }, black }
        };
        let (right, bottom) = (1.0 - w, 1.0 - h);
        let places = [(0.0, 0.0), (right, 0.0), (right, bottom), (0.0, bottom)];
        let mut corners = [tag(0, 0.0, 0.0); 4];
        for ((corner, id), (x, y)) in corners.iter_mut().zip(IDS).zip(places) {
            *corner = tag(id, x, y);
        }
        DisplayTags { corners, edge_m }
    }

    /// The corners of Pupil's default surface, which is the convex hull of the black squares of all tags, in fractions
    /// of the display: top left, top right, bottom right, bottom left.
    pub fn hull(&self) -> [[f64; 2]; 4] {
        let [top_left, top_right, bottom_right, bottom_left] = self.corners.map(|tag| tag.black);
        [
            [top_left.x, top_left.y],
            [top_right.x + top_right.w, top_right.y],
            [bottom_right.x + bottom_right.w, bottom_right.y + bottom_right.h],
            [bottom_left.x, bottom_left.y + bottom_left.h],
        ]
    }
}

impl DisplayTag {
    /// The corners of the tag's black square, in fractions of the display: top left, top right, bottom right, bottom
    /// left.
    pub fn black_corners(&self) -> [[f64; 2]; 4] {
        let DisplayArea { x, y, w, h } = self.black;
        [[x, y], [x + w, y], [x + w, y + h], [x, y + h]]
    }

    /// The cells of the AprilTag: rows from the top, cells from the left; true is black.
    pub fn cells(&self) -> [[bool; CELLS]; CELLS] {
        let data = DATA[usize::from(self.id)];
        let mut cells = [[false; CELLS]; CELLS];
        for (row, line) in cells.iter_mut().enumerate().skip(1).take(BLACK_CELLS) {
            for (column, cell) in line.iter_mut().enumerate().skip(1).take(BLACK_CELLS) {
                let in_data = |at: usize| (2..8).contains(&at);
                let is_white = in_data(row) && in_data(column) && data >> (35 - ((row - 2) * 6 + column - 2)) & 1 == 1;
                *cell = !is_white;
            }
        }
        cells
    }
}

fn overlap(a: DisplayArea, b: DisplayArea) -> bool {
    let meet = |a: f64, a_len: f64, b: f64, b_len: f64| a + a_len > b && b + b_len > a;
    meet(a.x, a.w, b.x, b.w) && meet(a.y, a.h, b.y, b.h)
}

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
