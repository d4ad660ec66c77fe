//! The velour command; everything is in the library.

fn main() -> std::process::ExitCode {
    velour::cli::run()
}
