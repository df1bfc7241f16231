//! Files of studies: recordings in folders, tables, reports, parts, pools, frozen plans, exports.

pub mod annotation_files;
pub mod bids_tree;
pub mod corrected;
pub mod export;
pub mod new_folder;
pub mod pool_file;
pub mod pupil_timestamps;
pub mod recordings;
pub mod simulated_trials;
pub mod study_part_file;
pub mod tournament_files;
pub mod training;
