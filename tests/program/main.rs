//! The program as people and scripts run it. Its tests run side by side: each has folders, ports and terminals of its own, and
//! waits for what must appear, however busy the machine is.

mod commands;
mod damage;
mod docs;
mod escapes;
mod exports;
mod forgetting;
mod forgetting_damage;
mod forgotten_answers;
mod overwriting;
#[cfg(unix)]
mod path_bytes;
mod plan;
mod power;
mod program;
mod pseudo_terminal;
#[path = "../library/raw_page.rs"]
mod raw_page;
mod stuck_terminal;
mod study_parts;
mod survival;
mod terminal;
