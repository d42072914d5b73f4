//! Programs in C beside the core: `rpi run --node N --target c` and `rpi replay --against c`.

use std::collections::BTreeMap;
use std::sync::Arc;

use rpi_c_target::{CCompiler, CProgram, CTargetError, Shadow};
use rpi_cli::{CompilerArgs, ExecutionTarget, TargetArgs};
use rpi_core::{Command, CommandId, Instance};
use rpi_diag::with_noun;
use rpi_image::Image;

/// Node in C beside the core.
pub(crate) struct ShadowedNode {
    shadow: Shadow,
    compiler: CCompiler,
    image: Image,
    cycles: u64,
    /// First difference from the core.
    difference: Option<String>,
}

impl ShadowedNode {
    /// Compiles the image of a node if the options request it.
    ///
    /// # Errors
    /// Returns the messages of the C compiler.
    pub(crate) fn start(
        image: &Image,
        args: &TargetArgs,
    ) -> Result<Option<ShadowedNode>, CTargetError> {
        if args.execution == ExecutionTarget::Core {
            return Ok(None);
        }
        let compiler = CCompiler::new(&args.compiler.cc);
        Ok(Some(ShadowedNode {
            shadow: Shadow::start(image, &compiler)?,
            compiler,
            image: image.clone(),
            cycles: 0,
            difference: None,
        }))
    }

    /// Repeats the cycle that the core has evaluated, unless there was a difference before.
    pub(crate) fn cycle(&mut self, instance: &Instance) {
        if self.difference.is_none() {
            self.cycles += 1;
            let difference = self.shadow.cycle(instance).err();
            self.difference = difference.map(|difference| difference.to_string());
        }
    }

    /// Returns the first difference from the core.
    pub(crate) fn difference(&self) -> Option<&str> {
        self.difference.as_deref()
    }

    /// Returns a line with the number of cycles that had the same bits and, for a microcontroller, the memory and the
    /// instructions that they need.
    ///
    /// # Errors
    /// If the program or a tool of the target fails.
    pub(crate) fn summary(&mut self) -> Result<String, CTargetError> {
        let same = format!(
            "the same bits in C ({}) in {}",
            self.compiler,
            with_noun(self.cycles, "cycle")
        );
        if !self.compiler.is_microcontroller() {
            return Ok(same);
        }
        let footprint = rpi_c_target::footprint(&self.image)?;
        let instructions = self.shadow.process().instructions()? / self.cycles.max(1);
        Ok(format!(
            "{same}; {footprint}, {} per cycle",
            with_noun(instructions, "instruction")
        ))
    }
}

/// Commands of a recording in C, beside their replay in the core.
pub(crate) struct ShadowedCommands {
    compiler: CCompiler,
    /// Compiled images, with the images themselves, so that their addresses stay distinct.
    programs: Vec<(Arc<Image>, Arc<CProgram>)>,
    /// Running command by the number of its place in the core. A new command ends the program of its predecessor there.
    running: BTreeMap<usize, (CommandId, Shadow)>,
    cycles: u64,
    error: Option<String>,
}

impl ShadowedCommands {
    pub(crate) fn new(args: &CompilerArgs) -> ShadowedCommands {
        ShadowedCommands {
            compiler: CCompiler::new(&args.cc),
            programs: Vec::new(),
            running: BTreeMap::new(),
            cycles: 0,
            error: None,
        }
    }

    /// Repeats the cycle that a command has evaluated in the tick with the number `tick`.
    pub(crate) fn cycle(&mut self, tick: u64, id: CommandId, command: &Command) {
        if self.error.is_some() {
            return;
        }
        let name = &command.instance().image().name;
        let result = self.shadow(id, command.instance());
        let result = result.map_err(|e| format!("{name} in C: {e}"));
        let result = result.and_then(|shadow| {
            let same = shadow.cycle(command.instance());
            same.map_err(|e| format!("DIFFERENT in tick {tick}: {name} in C, {e}"))
        });
        match result {
            Ok(()) => self.cycles += 1,
            Err(text) => self.error = Some(text),
        }
    }

    fn shadow(&mut self, id: CommandId, instance: &Instance) -> Result<&mut Shadow, CTargetError> {
        let is_known = self.running.get(&id.slot()).is_some_and(|r| r.0 == id);
        if !is_known {
            let shadow = Shadow::new(self.program(instance.image())?)?;
            self.running.insert(id.slot(), (id, shadow));
        }
        let found = self.running.get_mut(&id.slot()).map(|r| &mut r.1);
        found.ok_or_else(|| CTargetError("no such command".to_owned()))
    }

    fn program(&mut self, image: &Arc<Image>) -> Result<Arc<CProgram>, CTargetError> {
        let known = self.programs.iter().find(|p| Arc::ptr_eq(&p.0, image));
        if let Some((_, program)) = known {
            return Ok(Arc::clone(program));
        }
        let program = Arc::new(CProgram::compile(image, &self.compiler)?);
        self.programs
            .push((Arc::clone(image), Arc::clone(&program)));
        Ok(program)
    }

    /// Returns a line with the number of cycles that had the same bits.
    ///
    /// # Errors
    /// Returns the first difference, or the message of the C compiler.
    pub(crate) fn summary(self) -> Result<String, String> {
        match self.error {
            Some(error) => Err(error),
            None => Ok(format!(
                "the same bits in C ({}) in {} of commands",
                self.compiler,
                with_noun(self.cycles, "cycle")
            )),
        }
    }
}
