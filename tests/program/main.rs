//! The program as people and scripts run it. Its tests use terminals, ports, disks and times, so that each is `#[serial]`: they
//! run one after another.

mod commands;
mod damage;
mod docs;
mod escapes;
mod exports;
mod forgetting;
mod forgetting_damage;
mod forgetting_others;
mod forgotten_answers;
mod overwriting;
#[cfg(unix)]
mod path_bytes;
mod plan;
mod power;
mod stuck_terminal;
mod study_parts;
mod survival;
mod terminal;
mod tmux;
