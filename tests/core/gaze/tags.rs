//! The tags in the corners of the wall display, and the map from a tracker's surface to it.

use tomcom_core::gaze::tags::SurfaceHomography;
use tomcom_core::gaze::tags::{CELLS, DisplayTags};
use tomcom_core::kitchen::DisplayArea;

use crate::files::load;

fn overlap(a: DisplayArea, b: DisplayArea) -> bool {
    a.x < b.x + b.w && b.x < a.x + a.w && a.y < b.y + b.h && b.y < a.y + a.h
}

#[test]
fn tags_fit_the_corners_of_every_layout() {
    for layout in ["layouts/sushi.toml", "layouts/burger.toml"] {
        let kitchen = load(layout);
        let tags = DisplayTags::place(&kitchen).expect("room for the tags");
        assert!((0.08..=0.10).contains(&tags.edge_m), "{layout}: {} m", tags.edge_m);
        let areas = kitchen.locations.iter().map(|location| location.display);
        let areas: Vec<DisplayArea> = areas.chain(kitchen.storages.iter().map(|storage| storage.display)).collect();
        for (index, tag) in tags.corners.iter().enumerate() {
            assert!(areas.iter().all(|area| !overlap(tag.area, *area)), "{layout}: tag {}", tag.id);
            assert!(tags.corners[..index].iter().all(|other| other.id != tag.id && !overlap(other.area, tag.area)));
            // The quiet zone is one cell of the ten on every side, and the tag is square in metres.
            let sides_m = [tag.black.w * kitchen.display_m[0], tag.black.h * kitchen.display_m[1]];
            assert!(sides_m.iter().all(|side_m| (side_m - tags.edge_m).abs() < 1e-12));
            assert!((tag.black.x - tag.area.x - tag.area.w / CELLS as f64).abs() < 1e-12);
            // A tracker asks for the corners of the black square, clockwise from the top left.
            let cell = |at: f64| [tag.area.x + tag.area.w * at / 10.0, tag.area.y + tag.area.h * at / 10.0];
            let ([left, top], [right, bottom]) = (cell(1.0), cell(9.0));
            for (corner, expected) in
                tag.black_corners().into_iter().zip([[left, top], [right, top], [right, bottom], [left, bottom]])
            {
                assert!(corner.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{layout}: {corner:?}");
            }
            let edges = [tag.area.x, tag.area.y, 1.0 - tag.area.x - tag.area.w, 1.0 - tag.area.y - tag.area.h];
            assert_eq!(
                edges.iter().filter(|gap| gap.abs() < 1e-12).count(),
                2,
                "{layout}: tag {} in its corner",
                tag.id
            );
        }
    }
}

#[test]
fn tags_have_a_black_border_a_white_one_and_patterns_of_their_own() {
    let tags = DisplayTags::place(&load("layouts/sushi.toml")).expect("room for the tags");
    let cells = tags.corners.map(|tag| tag.cells());
    for (index, tag) in cells.iter().enumerate() {
        let last = CELLS - 1;
        let ring = |at: usize, far: usize| [tag[at][far], tag[far][at]];
        assert!((0..=last).all(|at| [ring(at, 0), ring(at, last)] == [[false; 2]; 2]), "the white border");
        assert!((1..last).all(|at| [ring(at, 1), ring(at, last - 1)] == [[true; 2]; 2]), "the black border");
        for other in &cells[..index] {
            let differing = tag.iter().flatten().zip(other.iter().flatten()).filter(|(a, b)| a != b).count();
            assert!(differing >= 11, "the family keeps eleven bits apart: {differing}");
        }
    }
    // The first row of data of id 0 is 0xd5d628584 >> 30 = 110101: white, white, black, white, black, white.
    assert_eq!(cells[0][2][2..8], [false, false, true, false, true, false]);
}

#[test]
fn a_location_in_a_corner_leaves_no_room_for_its_tag() {
    let mut kitchen = load("layouts/sushi.toml");
    kitchen.locations[0].display = DisplayArea { x: 0.90, y: 0.05, w: 0.08, h: 0.10 };
    let error = DisplayTags::place(&kitchen).expect_err("no room");
    assert_eq!(error.found, "\"order 1\" where the top right tag of the eye tracker has to be");
    assert_eq!(error.remedy, "0.10 m by 0.10 m free in each corner of the display");
}

#[test]
fn the_surface_maps_its_corners_and_straight_lines_to_the_display() {
    // The hull of the tags: what Pupil calls (0, 0) is the outer black corner of the bottom left tag.
    let hull = DisplayTags::place(&load("layouts/sushi.toml")).expect("room for the tags").hull();
    let map = SurfaceHomography::new(hull).expect("a surface");
    for (norm_pos, expected) in
        [([0.0, 1.0], hull[0]), ([1.0, 1.0], hull[1]), ([1.0, 0.0], hull[2]), ([0.0, 0.0], hull[3])]
    {
        let point = map.to_display(norm_pos).expect("a point");
        assert!(point.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{norm_pos:?}: {point:?}");
    }
    let centre = map.to_display([0.5, 0.5]).expect("a point");
    assert!(centre.iter().all(|value| (value - 0.5).abs() < 1e-12), "{centre:?}");
    // A surface that was drawn by hand, seen askew: its diagonals still meet where its centre is, which no affine map does.
    let corners = [[0.1, 0.1], [0.9, 0.2], [0.8, 0.9], [0.2, 0.7]];
    let map = SurfaceHomography::new(corners).expect("a surface");
    let [x, y] = map.to_display([0.5, 0.5]).expect("a point");
    let off_line = |a: [f64; 2], b: [f64; 2]| (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
    assert!(off_line(corners[0], corners[2]).abs() < 1e-12 && off_line(corners[1], corners[3]).abs() < 1e-12);
    assert_eq!(map.to_display([f64::NAN, 0.5]), None);
}

#[test]
fn corners_that_are_no_surface_are_none() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    assert!(SurfaceHomography::new(square).is_some());
    let reversed = [square[3], square[2], square[1], square[0]];
    let crossed = [square[0], square[2], square[1], square[3]];
    let flat = [[0.0, 0.5], [1.0, 0.5], [1.0, 0.5], [0.0, 0.5]];
    let endless = [[0.0, 0.0], [f64::NAN, 0.0], [1.0, 1.0], [0.0, 1.0]];
    for corners in [reversed, crossed, flat, endless] {
        assert_eq!(SurfaceHomography::new(corners), None, "{corners:?}");
    }
}
