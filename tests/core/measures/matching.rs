//! The similarity of two lanes of communications.

use rand::RngExt;
use tomcom_core::base::rng::stream;
use tomcom_core::communication::SignalKind;
use tomcom_core::kitchen::LocationId;
use tomcom_core::measures::matching::{
    CommunicationEvent, ComparedContent, MatchCounts, MatchCriterion, Similarity, matched,
};

use super::at;

/// A lane from "press:content" items: `q`, `w` are recipes of two orders, `a`, `b` highlights, `p` a proposal; a press is
/// two seconds.
fn lane(text: &str) -> Vec<CommunicationEvent> {
    let said = |item: &str| {
        let (press, letter) = item.split_once(':').expect("press:content");
        let press: u32 = press.parse().expect("a number");
        let (kind, target) = match letter {
            "q" => (SignalKind::Recipe, Some(0)),
            "w" => (SignalKind::Recipe, Some(1)),
            "a" => (SignalKind::Highlight, Some(2)),
            "b" => (SignalKind::Highlight, Some(3)),
            _ => (SignalKind::Proposal, None),
        };
        CommunicationEvent {
            press,
            clock: at(2.0 * f64::from(press)),
            content: ComparedContent { kind, target: target.map(LocationId) },
        }
    };
    text.split_whitespace().map(said).collect()
}

/// The figures of two lanes in a trial of so many presses.
fn alike(of: &str, with: &str, presses: u32, window: u32) -> Similarity {
    let mut tally = MatchCounts::default();
    tally.add(&lane(of), &lane(with), presses, window);
    tally.similarity()
}

fn near(found: Option<f64>, wanted: f64, what: &str) {
    let found = found.unwrap_or_else(|| panic!("{what} is null"));
    assert!((found - wanted).abs() < 1e-12, "{what} = {found}, not {wanted}");
}

#[test]
fn communications_match_one_to_one_within_the_window() {
    // Of the wizard's three, the recipe is one press early, the highlight too far, the third another target.
    let found = alike("4:q 10:a 20:b", "5:q 14:a 20:a", 30, 3);
    assert_eq!((found.of_n, found.with_n, found.matched), (3, 3, 1));
    near(found.signal.recall, 1.0 / 3.0, "recall");
    near(found.kind.recall, 2.0 / 3.0, "recall by kind");
    near(found.any.recall, 2.0 / 3.0, "recall of any signal");
    near(found.median_lead_s, -2.0, "the assistant came one press, two seconds, later");
    near(alike("4:q 10:a 20:b", "5:q 14:a 20:a", 30, 4).signal.recall, 2.0 / 3.0, "with a larger window");
    // One communication matches one, however many are near; the nearest, unless another pair would be lost.
    let found = alike("4:q", "2:q 4:q 6:q", 10, 3);
    assert_eq!(found.matched, 1);
    near(found.signal.precision, 1.0 / 3.0, "precision");
    near(found.signal.f1, 0.5, "F1");
    near(found.median_lead_s, 0.0, "the nearest");
    assert_eq!(matched(&lane("3:q 6:q"), &lane("5:q 9:q"), 3, MatchCriterion::Signal), [(0, 0), (1, 1)]);
    // Different targets may cross.
    assert_eq!(matched(&lane("3:q 4:a"), &lane("3:a 4:q"), 1, MatchCriterion::Signal), [(0, 1), (1, 0)]);
}

#[test]
fn what_cannot_be_said_of_empty_lanes_is_null() {
    let found = alike("", "3:q", 10, 3);
    assert_eq!((found.signal.recall, found.signal.f1), (None, Some(0.0)));
    assert_eq!((found.median_lead_s, found.signal.chance_recall), (None, None));
    let nothing = alike("", "", 10, 3);
    assert_eq!((nothing.kappa, nothing.signal.f1), (None, None));
    assert_eq!(alike("2:q", "2:q", 4, 3).signal.chance_recall, None, "too short for a shift by more than the window");
}

#[test]
fn kappa_is_over_presses_and_counts_matched_pairs_as_agreement() {
    // Nine presses make ten places: six silent, one agreed recipe, one only of each, one with two targets.
    let found = alike("2:q 4:a 8:a", "3:q 6:b 8:b", 9, 1);
    let units: f64 = 6.0 + 1.0 + 1.0 + 1.0 + 1.0;
    let agreed = 7.0 / units;
    // Margins of the first lane: nothing 7, q 1, a 2; of the second: nothing 7, q 1, b 2.
    let chance = (7.0 * 7.0 + 1.0) / (units * units);
    near(found.kappa, (agreed - chance) / (1.0 - chance), "kappa");
    near(alike("2:q 4:a", "2:q 4:a", 9, 3).kappa, 1.0, "kappa of equal lanes");
    let apart = alike("1:q", "8:q", 9, 0).kappa.expect("a kappa");
    assert!(apart < 0.0, "less than chance: {apart}");
}

#[test]
fn the_chance_level_is_what_circular_shifts_leave() {
    // Eleven places; the one communication of the second lane meets the first's in one of the ten shifts.
    near(alike("3:q", "7:q", 10, 0).signal.chance_recall, 0.1, "one place of ten");
    // Without a shift by at most one press: eight shifts, of which seven to nine land within one press of press 3.
    near(alike("3:q", "7:q", 10, 1).signal.chance_recall, 3.0 / 8.0, "three places of eight");
    let other = alike("3:q", "7:w", 10, 1);
    near(other.signal.chance_recall, 0.0, "another target never matches");
    near(other.kind.chance_recall, 3.0 / 8.0, "another target of the same kind");
    let highlight = alike("3:q", "7:a", 10, 1);
    near(highlight.kind.chance_recall, 0.0, "another kind never matches");
    near(highlight.any.chance_recall, 3.0 / 8.0, "any signal");
    near(highlight.headline.chance_recall, 0.0, "the headline is the strictest level");
}

/// The most pairs, and with those the least presses between them, by trying everything.
fn most(of: &[CommunicationEvent], with: &[CommunicationEvent], window: u32, likeness: MatchCriterion) -> (usize, u32) {
    let Some((first, rest)) = of.split_first() else { return (0, 0) };
    let mut best = most(rest, with, window, likeness);
    for (index, other) in with.iter().enumerate() {
        let same = match likeness {
            MatchCriterion::Signal => first.content == other.content,
            MatchCriterion::Kind => first.content.kind == other.content.kind,
            MatchCriterion::Any => true,
        };
        let apart = first.press.abs_diff(other.press);
        if same && apart <= window {
            let left: Vec<CommunicationEvent> =
                with.iter().enumerate().filter(|(at, _)| *at != index).map(|(_, one)| *one).collect();
            let (pairs, between) = most(rest, &left, window, likeness);
            let found = (pairs + 1, between + apart);
            if found.0 > best.0 || found.0 == best.0 && found.1 < best.1 {
                best = found;
            }
        }
    }
    best
}

#[test]
fn no_matching_has_more_or_nearer_pairs() {
    let mut random = stream(1, "lanes", 0);
    for round in 0..300 {
        let mut draw = || {
            let mut presses: Vec<u32> = (0..random.random_range(0..6)).map(|_| random.random_range(0..14)).collect();
            presses.sort_unstable();
            let items: Vec<String> = presses
                .iter()
                .map(|press| format!("{press}:{}", ["q", "w", "a", "b", "p"][random.random_range(0..5)]))
                .collect();
            items.join(" ")
        };
        let (of, with) = (draw(), draw());
        let (a, b) = (lane(&of), lane(&with));
        let mut wider = 0;
        for window in 0..6 {
            for likeness in [MatchCriterion::Signal, MatchCriterion::Kind, MatchCriterion::Any] {
                let pairs = matched(&a, &b, window, likeness);
                let between: u32 = pairs.iter().map(|&(i, j)| a[i].press.abs_diff(b[j].press)).sum();
                let wanted = most(&a, &b, window, likeness);
                assert_eq!(
                    (pairs.len(), between),
                    wanted,
                    "round {round}: {of} | {with} within {window}, {likeness:?}"
                );
                let mirrored = matched(&b, &a, window, likeness);
                assert_eq!(mirrored.len(), pairs.len(), "it is symmetric");
            }
            let found = alike(&of, &with, 14, window);
            assert!(found.matched >= wider, "a wider window loses nothing");
            wider = found.matched;
            assert!(found.kappa.is_none_or(|kappa| kappa <= 1.0 + 1e-12));
            let shares = [found.signal.recall, found.signal.precision, found.signal.f1, found.signal.chance_recall];
            assert!(shares.iter().flatten().all(|share| (0.0..=1.0 + 1e-12).contains(share)), "{shares:?}");
        }
    }
}
