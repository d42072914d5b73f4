//! Functional Mock-up Units: the library for this machine, and the archive with all files.

use super::archive::Archive;
use super::compiler::{CCompiler, CTargetError};
use rpi_codegen::Fmu;

/// Compiles the library of a unit for this machine. Returns the bytes of the archive, a file with the ending `.fmu`.
///
/// # Errors
/// Returns the messages of the C compiler.
pub fn package(fmu: &Fmu, compiler: &CCompiler) -> Result<Vec<u8>, CTargetError> {
    let library = compiler.build(&fmu.source, &["-shared", "-fPIC", "-fvisibility=hidden"])?;
    let path = library.path();
    let library = rpi_files::read_unchanged(&path, rpi_files::MAX_PROGRAM);
    let library = library.map_err(|e| CTargetError(format!("{}: {e}", path.display())))?;
    let name = &fmu.name;
    let system = match std::env::consts::OS {
        "macos" => "darwin",
        other => other,
    };
    let machine = format!("{}-{system}", std::env::consts::ARCH);
    let ending = std::env::consts::DLL_SUFFIX;
    let files = [
        (
            "modelDescription.xml".to_owned(),
            fmu.model_description.as_bytes(),
        ),
        (
            "sources/buildDescription.xml".to_owned(),
            fmu.build_description.as_bytes(),
        ),
        (format!("sources/{name}.c"), fmu.source.as_bytes()),
        (format!("binaries/{machine}/{name}{ending}"), &library[..]),
    ];
    let mut archive = Archive::default();
    let fits = files
        .iter()
        .all(|(path, content)| archive.add(path, content));
    let bytes = archive.finish().filter(|_| fits);
    bytes.ok_or_else(|| CTargetError("the unit is larger than 4 GB".to_owned()))
}
