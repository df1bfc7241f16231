//! The binary `tomcom`; everything is in the library, see `tomcom::cli`.

use std::process::ExitCode;

fn main() -> ExitCode {
    tomcom::cli::main()
}
