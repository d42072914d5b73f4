//! Options of the subcommands that run programs in C beside the control core.

use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Target on which a program runs.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, ValueEnum)]
pub enum ExecutionTarget {
    /// The control core.
    #[default]
    Core,
    /// The control core, and the program in C beside it: a difference of any value, bit by bit, is an error.
    C,
}

/// Options that select the target and the C compiler.
#[derive(Args, Debug, Clone)]
pub struct TargetArgs {
    /// Target on which the program runs. With `c`, it is translated to C, compiled, and runs the same cycles beside the
    /// core; every value must have the same bits.
    #[arg(long = "target", value_name = "TARGET", default_value = "core")]
    pub execution: ExecutionTarget,
    /// C source, object file or library with the external functions of the program. They run in a process of their own.
    #[arg(long = "extern", value_name = "FILE")]
    pub external: Vec<PathBuf>,
    /// C compiler.
    #[command(flatten)]
    pub compiler: CompilerArgs,
}

/// Option that selects the C compiler.
#[derive(Args, Debug, Clone)]
pub struct CompilerArgs {
    /// C compiler with its options, such as `clang -O3`. `cortex-m4` compiles with arm-none-eabi-gcc and runs the program
    /// on a microcontroller in QEMU.
    #[arg(long, value_name = "COMMAND", default_value = "cc -O2")]
    pub cc: String,
}
