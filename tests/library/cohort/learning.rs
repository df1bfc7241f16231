//! What one trial teaches a simulated participant for the next.

use std::sync::Arc;

use tomcom_core::kitchen::{Agent, AspectId, DishId, Kitchen};
use tomcom_people::participant::SimulatedParticipant;
use tomcom_people::participant::population::{Experience, Population};

use super::paper;

#[test]
fn trials_teach_recipes_and_presses_where_the_population_learns() {
    let kitchen: Arc<Kitchen> = Arc::new(paper(1).kitchen.kitchen);
    let known = |population: &Population, trials: u32| {
        let experience = Experience { trials, presses: 200.0 * f64::from(trials) };
        let one = SimulatedParticipant::new(kitchen.clone(), population, 7, 3, 11, experience);
        let empty = kitchen.empty_state();
        let dishes = (0..kitchen.dishes.len()).map(|index| kitchen.aspect_of_dish(DishId(index as u8)));
        let sum: f64 = dishes.map(|dish: AspectId| one.beliefs().p_truth(&kitchen, empty, dish)).sum();
        (sum, one.person().clone())
    };
    let afresh = Population::default();
    assert_eq!(known(&afresh, 0), known(&afresh, 1), "by default a trial teaches nothing for the next one");
    let learns = Population { recipes_gained: 2.0, ..afresh };
    let ((first, before), (second, after)) = (known(&learns, 0), known(&learns, 1));
    assert!(second > first, "{second} after {first}");
    let odds = |p: f64| p / (1.0 - p);
    assert!((odds(after.learned) / odds(before.learned) - 2.0).abs() < 1e-9);
    assert_eq!(after.slip, before.slip, "it is the same person");
    assert!(kitchen.buttons[Agent::Human.index()].len() > 1);
}
