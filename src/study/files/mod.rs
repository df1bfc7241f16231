//! Files of studies: recordings in folders, tables, reports, parts, pools, frozen plans, exports.

pub mod bids_tree;
pub mod export;
pub mod frozen_file;
#[cfg(feature = "mcap")]
pub mod mcap_file;
pub mod pool_file;
pub mod power_files;
pub mod recordings;
pub mod simulated_trials;
pub mod study_part_file;
pub mod training;
pub mod written_tables;
