//! The binary `tomcom-research`; everything is in the library, see `tomcom_research::cli`.

use std::process::ExitCode;

fn main() -> ExitCode {
    tomcom_research::cli::main()
}
