//! The mouse: the place on the display under the pointer, clicks and the wheel.

use tomcom::console::kitchen_map::KitchenMap;
use tomcom::console::kitchen_map::KitchenMapElement;
use tomcom::console::view::regions::PanelAreas;
use tomcom::console::{ConsoleMessage, update};
use tomcom_session::settings::{ParticipantKind, WizardVisibility};

use super::{SIZES, Stage, panels};
use crate::kitchen;

#[test]
fn every_place_of_the_panel_is_its_place_on_the_display_and_back() {
    for name in ["sushi", "burger"] {
        let kitchen = kitchen(name);
        for size in SIZES {
            let panel = PanelAreas::new(size, WizardVisibility::Recommendation, None).kitchen_inside();
            let plan = KitchenMap::new(&kitchen, panel, size.0 == 120);
            assert_eq!(plan.spots.len(), kitchen.locations.len() + kitchen.storages.len());
            for spot in &plan.spots {
                let area = match spot.thing {
                    KitchenMapElement::Location(id) => kitchen.location(id).display,
                    KitchenMapElement::Storage(index) => kitchen.storages[index].display,
                };
                assert_eq!(panel.union(spot.cells), panel, "{name} {size:?}: inside of the panel");
                for (x, y) in [(spot.cells.x, spot.cells.y), (spot.cells.right() - 1, spot.cells.bottom() - 1)] {
                    let point = plan.display_point(x, y);
                    let distance_m = area.distance_m(point, kitchen.display_m);
                    assert_eq!(distance_m, 0.0, "{name} {size:?} {:?} {point:?} {area:?}", spot.thing);
                    assert_eq!(plan.cell(point), Some((x, y)), "{name} {size:?}");
                }
            }
            for (index, spot) in plan.spots.iter().enumerate() {
                let others = plan.spots[index + 1..].iter();
                assert!(others.clone().all(|other| !spot.cells.intersects(other.cells)), "{name} {size:?}: apart");
            }
        }
    }
}

#[test]
fn a_click_beside_the_keys_explains_a_place_or_shows_a_panel_and_the_wheel_goes_back_in_time() {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    let regions = PanelAreas::new((120, 40), WizardVisibility::Recommendation, None);
    let plan = KitchenMap::new(&stage.session.kitchen, regions.kitchen_inside(), false);
    for spot in &plan.spots {
        let KitchenMapElement::Location(location) = spot.thing else { continue };
        let click = ConsoleMessage::Click(spot.cells.x + 1, spot.cells.bottom() - 1);
        assert_eq!(update(&mut stage.model, &stage.session, click), None);
        let label = stage.session.kitchen.location(location).label();
        assert!(stage.notice().contains(&label), "{label}: {}", stage.notice());
    }
    let all = panels(&stage);
    let (column, row) = (regions.belief.x + 1, regions.belief.y);
    for expected in [["belief", "recommendation"].map(str::to_string).to_vec(), all] {
        assert_eq!(update(&mut stage.model, &stage.session, ConsoleMessage::Click(column, row)), None);
        assert_eq!(panels(&stage), expected);
    }
    let (column, row) = (regions.timeline.x + 1, regions.timeline.y);
    for (steps, back_s) in [(1, 5), (-3, 0)] {
        assert_eq!(update(&mut stage.model, &stage.session, ConsoleMessage::Wheel(column, row, steps)), None);
        assert_eq!(stage.model.timeline_back_s, back_s, "back, and not into the future");
    }
}
