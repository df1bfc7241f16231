//! Wizard and assistants side by side, and a difference between them opened.

use std::sync::Arc;

use crossterm::event::KeyCode;
use tomcom::console::console_model::Dialog;
use tomcom::console::console_model::SenderComparisonView;
use tomcom::console::panels::Panel;
use tomcom::console::panels::screen;
use tomcom::console::view::theme::{TerminalBackground, Theme};
use tomcom_core::base::time::SessionTime;
use tomcom_core::communication::Signal;
use tomcom_core::communication::concept::ConceptName;
use tomcom_core::communication::recommendation::{Recommendation, SignalOption};
use tomcom_core::measures::matching::CommunicationEvent;
use tomcom_session::history::belief_track::BeliefSnapshot;
use tomcom_session::history::comparison::{
    Communication, CommunicationContent, CommunicationContext, SenderCommunications, SenderComparison,
};
use tomcom_session::settings::ParticipantKind;

use super::{SIZES, Stage};
use crate::check_snapshot;

/// The sushi kitchen, compared: the wizard with so many assistants.
fn compared(assistants: usize) -> Stage {
    let mut stage = Stage::sushi(ParticipantKind::Simulated);
    stage.model.keys = stage.model.keys.clone().with_comparison();
    let kitchen = stage.session.kitchen.clone();
    let recipe = |order: &str| CommunicationContent::Signal(Signal::ShowRecipe(order.to_string()));
    let highlight = |place: &str| CommunicationContent::Signal(Signal::Highlight(place.to_string()));
    let held = BeliefSnapshot::new(&kitchen, stage.session.state, &stage.belief, stage.model.now, false).held;
    let said = |press: u32, seconds: f64, what: CommunicationContent| {
        let best = if let CommunicationContent::Signal(signal) = &what { Some(signal.clone()) } else { None };
        let option = |signal: &Signal| SignalOption {
            signal: signal.clone(),
            benefit: 4.2,
            standard_error: 0.2,
            net: 2.7,
            rollouts: 256,
        };
        let options = best.iter().map(option).collect();
        let advice = Recommendation { options, best, ..Recommendation::silent(7, stage.model.now) };
        let (state, screen) = (stage.session.state, Some(screen(&stage.session, &stage.model)));
        let known = CommunicationContext { seq: 7, state, held: held.clone(), advice: vec![advice; 3], screen };
        let clock = SessionTime::from_secs_f64(seconds - 3.0);
        let said = CommunicationEvent { press, clock, content: what.content(&kitchen) };
        Communication { said, time: SessionTime::from_secs_f64(seconds), what, known: Some(Arc::new(known)) }
    };
    let lane = |name: &str, concept, spoken| SenderCommunications { name: name.to_string(), concept, spoken };
    let sent = vec![said(5, 12.0, highlight("cutting_board")), said(9, 21.8, recipe("order_1"))];
    let planned = vec![
        said(2, 8.2, highlight("cooking_pot")),
        said(5, 10.6, highlight("cutting_board")),
        said(9, 21.1, recipe("order_1")),
    ];
    let proposed = CommunicationContent::Proposal(vec!["take_nori".to_string(), "assembly_board".to_string()]);
    let mut lanes = vec![
        lane("wizard", None, sent),
        lane("tom-com", Some(ConceptName::TomCom), planned),
        lane("tom", Some(ConceptName::Tom), vec![said(4, 9.3, recipe("order_1")), said(9, 22.1, recipe("order_1"))]),
        lane("dev", Some(ConceptName::Dev), vec![said(6, 15.0, proposed)]),
    ];
    lanes.truncate(assistants + 1);
    let mut comparison = SenderComparisonView::default();
    comparison.show(SenderComparison::new(lanes, 3, 10, false));
    stage.model.comparison = Some(comparison);
    stage
}

#[test]
fn wizard_and_assistant_stand_side_by_side_at_every_size() {
    let figures = ["recall 1.00", "precision 0.67, F1 0.80, kappa 0.77, lead +1.0 s"];
    let mut plain = compared(3);
    plain.model.theme = Theme { colour: false, unicode: false, ground: TerminalBackground::Dark };
    for size in SIZES {
        let one = compared(1);
        one.shows(size, &figures);
        // The lead of the assistant is a line between two signals.
        one.shows(size, &["1/1  0:05  only tom-com: highlight cooking pot", "p c", "╭─╯"]);
        compared(3).shows(size, &figures);
        compared(3).shows(size, &["5/5  0:12  dev, not wizard: press take nori, then assembly board", "◆"]);
        assert!(plain.screen(size).is_ascii(), "{}", plain.screen(size));
    }
    check_snapshot("console", "compared_all_120x40", compared(3).screen((120, 40)));
}

#[test]
fn a_difference_is_chosen_and_opened_by_keys_and_the_screen_says_what_was_seen() {
    let mut stage = compared(1);
    let panels = screen(&stage.session, &stage.model).panels;
    assert!(panels.iter().any(|panel| panel == "comparison"), "{panels:?}");
    assert_eq!(
        stage.model.comparison.as_ref().and_then(|one| one.seen.as_ref()).map(|one| one.differences.len()),
        Some(1)
    );
    let mut stage_of_all = compared(3);
    for (stage, words) in
        [(&mut stage, "0:05  only tom-com: highlight cooking pot"), (&mut stage_of_all, "dev, not wizard")]
    {
        assert!(stage.screen((120, 40)).contains(words), "{}", stage.screen((120, 40)));
        stage.control('o');
        assert_eq!(screen(&stage.session, &stage.model).dialog.as_deref(), Some("difference"));
        let opened = stage.screen((120, 40));
        for told in [
            "What wizard and assistant knew",
            "true contents of the kitchen:",
            "panels on the wizard's screen: kitchen",
        ] {
            assert!(opened.contains(told), "{told} in\n{opened}");
        }
    }
    check_snapshot("console", "compared_opened_120x40", stage.screen((120, 40)));
    // The one before, without closing; then any key closes.
    stage_of_all.control('t');
    assert!(matches!(stage_of_all.model.dialog, Some(Dialog::Difference(_))));
    assert!(!stage_of_all.screen((120, 40)).contains("dev, not wizard: press take nori, then assembly board\npress"));
    stage_of_all.key(KeyCode::Char('x'));
    assert_eq!(stage_of_all.model.dialog, None);
    // Without a comparison the keys have no meaning.
    let mut alone = Stage::sushi(ParticipantKind::Simulated);
    alone.control('o');
    assert_eq!(alone.model.dialog, None);
}

#[test]
fn every_lane_of_a_comparison_fits_the_smallest_console() {
    let small = compared(3).screen((80, 24));
    for lane in ["wizard", "tom-com", "tom ", "dev"] {
        assert!(small.contains(lane), "{lane} in\n{small}");
    }
    let alone = {
        let mut stage = compared(3);
        stage.model.alone = Some(Panel::Comparison);
        stage.screen((80, 24))
    };
    for figure in ["recall", "kappa", "lead", "1/"] {
        assert!(alone.contains(figure), "{figure} in\n{alone}");
    }
}
