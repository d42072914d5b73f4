//! Tests in C beside the core: `rpic test --target c`.

use rpi_c_target::{CCompiler, CTargetError, Difference, Shadow};
use rpi_cli::{ExecutionTarget, TargetArgs};
use rpi_core::Instance;
use rpi_image::Image;

/// Test in C beside the core.
pub(crate) struct TestInC {
    shadow: Shadow,
    difference: Option<Difference>,
}

impl TestInC {
    /// Compiles the image of a test if the options request it.
    ///
    /// # Errors
    /// Returns the messages of the C compiler.
    pub(crate) fn start(image: &Image, args: &TargetArgs) -> Result<Option<TestInC>, CTargetError> {
        if args.execution == ExecutionTarget::Core {
            return Ok(None);
        }
        let compiler = CCompiler::new(&args.compiler.cc);
        Ok(Some(TestInC {
            shadow: Shadow::start(image, &compiler)?,
            difference: None,
        }))
    }

    /// Repeats the cycle that the core has evaluated, unless there was a difference before.
    pub(crate) fn cycle(&mut self, instance: &Instance) {
        if self.difference.is_none() {
            self.difference = self.shadow.cycle(instance).err();
        }
    }

    /// Returns the first difference from the core as text.
    pub(crate) fn difference(self) -> Option<String> {
        let difference = self.difference?;
        Some(format!(
            "the program in C differs from the core: {difference}"
        ))
    }
}
