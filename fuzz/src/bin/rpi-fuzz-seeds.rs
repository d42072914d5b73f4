//! Writes the initial corpus and the dictionary of a fuzzer: `rpi-fuzz-seeds ENTRY FOLDER DICTIONARY`.

use std::fs;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [entry, folder, words] = args.as_slice() else {
        eprintln!("usage: rpi-fuzz-seeds ENTRY FOLDER DICTIONARY");
        return ExitCode::from(2);
    };
    match write(entry, Path::new(folder), Path::new(words)) {
        Ok(count) => {
            println!("{count} seeds");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn write(name: &str, folder: &Path, words: &Path) -> std::io::Result<usize> {
    let entry = rpi_fuzz::entry(name)
        .ok_or_else(|| std::io::Error::other(format!("unknown entry point: {name}")))?;
    fs::create_dir_all(folder)?;
    fs::write(words, rpi_fuzz::dictionary())?;
    let mut seeds = (entry.seeds)();
    seeds.extend(rpi_fuzz::saved_inputs(name));
    for seed in &seeds {
        fs::write(folder.join(&seed.name), &seed.bytes)?;
    }
    Ok(seeds.len())
}
