//! The same cycles in the core and in C, with the devices of a bank.

use super::compiler::{CCompiler, CTargetError};
use super::process::CProcess;
use super::shadow::{Difference, Shadow};
use rpi_core::{CycleContext, Instance, LoadError};
use rpi_device::DeviceBank;
use rpi_image::Image;
use std::sync::Arc;

/// Image that runs in the core and in C.
pub struct Lockstep {
    machine: Instance,
    shadow: Shadow,
}

impl Lockstep {
    /// Loads an image in the core and starts it as a C program.
    ///
    /// # Errors
    /// Returns the reason why the image cannot be loaded or compiled.
    pub fn start(
        image: &Arc<Image>,
        bank: &mut dyn DeviceBank,
        compiler: &CCompiler,
    ) -> Result<Lockstep, CTargetError> {
        let text = |errors: Vec<LoadError>| {
            let texts: Vec<String> = errors.iter().map(ToString::to_string).collect();
            CTargetError(texts.join("\n"))
        };
        Ok(Lockstep {
            machine: Instance::load(Arc::clone(image), bank).map_err(text)?,
            shadow: Shadow::start(image, compiler)?,
        })
    }

    /// Returns the instance in the core, to set its inputs. After its reset, the program in C begins anew, too.
    pub fn instance(&mut self) -> &mut Instance {
        &mut self.machine
    }

    /// Returns the program in C.
    pub fn process(&mut self) -> &mut CProcess {
        self.shadow.process()
    }

    /// Runs one cycle on both sides. Returns whether the command continues.
    ///
    /// # Errors
    /// Returns the first difference.
    pub fn cycle(
        &mut self,
        bank: &mut dyn DeviceBank,
        context: &CycleContext,
    ) -> Result<bool, Difference> {
        self.machine.read(bank, context);
        self.machine.evaluate(bank);
        self.shadow.cycle(&self.machine)?;
        let verdict = self.machine.verdict(&[]);
        self.machine.commit();
        self.machine.hand_over(bank);
        Ok(verdict.is_none())
    }
}
