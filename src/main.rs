use std::process::ExitCode;

fn main() -> ExitCode {
    tomcom::cli::main()
}
