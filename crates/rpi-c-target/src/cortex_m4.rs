//! Microcontroller in an emulator: the board mps2-an386 with a Cortex-M4, in QEMU.
//!
//! The C library of the compiler passes the standard streams of the program to the emulator (semihosting), so that the
//! board runs the same program as other targets.

use super::compiler::{CCompiler, CTargetError};
use super::process::plain_options;
use rpi_codegen::{Emitted, emit};
use rpi_image::Image;
use std::fmt;
use std::process::Command;

/// Name of the target among the commands of C compilers.
pub(crate) const NAME: &str = "cortex-m4";

/// Time of an instruction in the emulator in ns: 2 to the power of the number after `shift=`.
const NS_PER_INSTRUCTION: u64 = 64;
/// Period of the clock of the board in ns, at 25 MHz.
const NS_PER_CLOCK: u64 = 40;

const COMPILER: &str = "arm-none-eabi-gcc";
const MACHINE: &[&str] = &[
    "-mcpu=cortex-m4",
    "-mthumb",
    "-mfloat-abi=hard",
    "-mfpu=fpv4-sp-d16",
];
const LINKER: &[&str] = &["-T", "board.ld", "board.c", "-Wl,--no-warn-rwx-segments"];
const EMULATOR: &[&str] = &[
    "qemu-system-arm",
    "-machine",
    "mps2-an386",
    "-icount",
    "shift=6",
    "-display",
    "none",
    "-monitor",
    "none",
    "-serial",
    "none",
    "-semihosting-config",
    "enable=on,target=native",
    "-kernel",
];
const FILES: &[(&str, &str)] = &[
    ("board.c", include_str!("cortex_m4/board.c")),
    ("board.h", include_str!("cortex_m4/board.h")),
    ("board.ld", include_str!("cortex_m4/board.ld")),
];

/// Returns the compiler of the board with further options; `-O2` without any.
pub(crate) fn compiler(mut options: Vec<String>) -> CCompiler {
    if options.is_empty() {
        options.push("-O2".to_owned());
    }
    let board = ["--specs=rdimon.specs", "-include", "board.h"];
    let fixed = MACHINE.iter().chain(&board).chain(LINKER);
    options.extend(fixed.map(|option| (*option).to_owned()));
    CCompiler {
        program: COMPILER.to_owned(),
        options,
        ending: "c",
        runner: EMULATOR,
        files: FILES,
    }
}

/// Returns the number of instructions in a number of periods of the clock.
pub(crate) const fn instructions(clocks: u64) -> u64 {
    clocks * NS_PER_CLOCK / NS_PER_INSTRUCTION
}

/// Memory that a program needs on the board, without input and output for tests.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Footprint {
    /// Code and constants in bytes.
    pub flash: u64,
    /// State, inputs and outputs of one instance in bytes, without the stack.
    pub ram: u64,
}

impl fmt::Display for Footprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "flash {} B, RAM {} B", self.flash, self.ram)
    }
}

/// Returns the memory that an image needs on the board: of a program that only runs its cycles, optimised for speed,
/// with the parts of the libraries that it uses.
///
/// # Errors
/// Returns the messages of the tools.
pub fn footprint(image: &Image) -> Result<Footprint, CTargetError> {
    let name = &rpi_codegen::program_name(&image.name);
    let Emitted { source, .. } = emit(image, &plain_options(name));
    let main = format!(
        "\nstatic {name}_state program_state;\nstatic {name}_in program_in;\nstatic {name}_out program_out;\n\
         void _start(void);\n\
         void _start(void) {{\n  {name}_init(&program_in);\n  {name}_reset(&program_state);\n  for (;;) {{\n    (void){name}_step(&program_state, &program_in, &program_out);\n  }}\n}}\n"
    );
    let functions = device_functions(image, name);
    let compiler = CCompiler {
        options: MACHINE
            .iter()
            .chain(LINKER)
            .map(|o| (*o).to_owned())
            .collect(),
        ..compiler(Vec::new())
    };
    let options = [
        "-O2",
        "-nostartfiles",
        "--specs=nosys.specs",
        "-ffunction-sections",
        "-fdata-sections",
        "-Wl,--gc-sections",
    ];
    let binary = compiler.build(&(source + &functions + &main), &options)?;
    let output = Command::new("arm-none-eabi-size")
        .arg(binary.path())
        .output();
    let output = output.map_err(|e| CTargetError(format!("arm-none-eabi-size: {e}")))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    sizes(&text).ok_or_else(|| CTargetError(format!("arm-none-eabi-size: {text}")))
}

/// Returns definitions of the device functions, which are not part of the program, without a result.
fn device_functions(image: &Image, name: &str) -> String {
    let functions = (0..).zip(&image.functions);
    let names = functions.map(|(k, function)| rpi_codegen::function_name(name, function, k));
    names
        .map(|function| {
            format!(
                "\nbool {function}(void *device, const rpi_word *arguments, rpi_word *results) {{\n  (void)device;\n  (void)arguments;\n  (void)results;\n  return false;\n}}\n"
            )
        })
        .collect()
}

/// Reads the table of the tool `size`: a line of titles, and a line with the sizes of code, data and zeroed data.
fn sizes(text: &str) -> Option<Footprint> {
    let mut numbers = text.lines().nth(1)?.split_whitespace();
    let mut number = || numbers.next()?.parse::<u64>().ok();
    let (code, data, zeroed) = (number()?, number()?, number()?);
    Some(Footprint {
        flash: code + data,
        ram: data + zeroed,
    })
}
