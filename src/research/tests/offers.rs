//! Steadiness of offers: every offer of the recordings is counted, and the hand that reads them is seeded.

use tomcom_core::communication::settings::ShadowMode;
use tomcom_research::offers::measure;
use tomcom_session::replay::RecordingReplay;
use tomcom_session::settings::Condition;
use tomcom_study::analysis::offer_summary::TimedOffer;
use tomcom_study::gathered::GatheredRecordings;

use crate::{folder, recorded, session};

#[test]
fn the_measured_hand_reads_offers_and_every_offer_is_counted() {
    // Trials of an unassisted session with an assistant that advises unseen.
    let mut files = session("default.toml");
    (files.spec.trial.condition, files.spec.assistant.shadow) = (Condition::None, ShadowMode::On);
    files.spec.assistant.rollout.rollouts = 32;
    (files.spec.seed, files.spec.trial.seconds) = (7, 120.0);
    let recordings = recorded(&files, 2, &folder("offers"));
    let gathered = GatheredRecordings::find(&recordings).expect("recordings");
    let found = measure(&gathered, || ()).expect("recordings");
    let (mut offers, mut visible) = (0, 0);
    for recording in &recordings {
        let mut replay = RecordingReplay::open(recording).expect("a recording");
        replay.run().expect("a recording");
        offers += TimedOffer::all(replay.session()).len() as u64;
        visible += TimedOffer::visible(replay.session()).len();
    }
    assert_eq!((found.offers.all.n, visible), (offers, 0), "nobody could see them");
    let hand = found.hand;
    assert!(hand.readings > 0 && hand.readings == hand.as_read + hand.something_else + hand.nothing, "{hand:?}");
    assert_eq!(measure(&gathered, || ()).expect("recordings"), found, "the hand is seeded");
}
