//! Goes to the cycles of a recording, and evaluates expressions in them.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use rpi_core::{Command, CommandId};
use rpi_driver::Compiled;
use rpi_record::mcap::{Recording, ReplayTimeline};
use rpi_syntax::Dialect;

use crate::breakpoint::{Breakpoint, BreakpointWatch, Hit};
use crate::error::DebugError;
use crate::flow_table::FlowTable;
use crate::insertion::insertion_point;
use crate::program::{ALL_FLOWS, CompiledForReplay, RecordedProgram};
use crate::stop::{RunningCommand, Stop};

/// First letters of the names of flows that the debugger adds to a program.
const ADDED: &str = "rpi_debug_";

/// Maximum number of expressions that are compiled with a program.
const MAX_EXPRESSIONS: usize = 200;

/// Number of ticks that a search backwards replays at once at first; it doubles with each further step.
const FIRST_SEARCH: u64 = 1000;

/// Number of an expression that was added to the program.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct ExpressionId(usize);

/// Expression that is evaluated with the equations of a line.
#[derive(Clone, PartialEq, Eq, Debug)]
struct Expression {
    line: u32,
    text: String,
}

/// A recording that is replayed with a program.
struct Replay {
    compiled: Compiled,
    tables: Vec<FlowTable>,
    timeline: ReplayTimeline,
}

/// A recording that is debugged: a position in it, the values there, and the expressions that are evaluated with the program.
pub struct Debugger {
    /// The recording as it was read, with its own images.
    original: Recording,
    /// Largest number of ticks between two cycles of a command.
    longest_period: u64,
    program: RecordedProgram,
    expressions: Vec<Expression>,
    replay: Replay,
    stop: Stop,
    /// Number of requests that end a search where it is.
    interrupt: Arc<AtomicUsize>,
}

impl Debugger {
    /// Compiles the program of a recording again, and goes to the first cycle of a command.
    ///
    /// # Errors
    /// Returns an error if the program is not the one that was recorded, or if the recording cannot be replayed.
    pub fn new(original: Recording, program: RecordedProgram) -> Result<Debugger, DebugError> {
        let mut debugger = Debugger {
            longest_period: original.longest_period(),
            replay: Replay::new(&original, &program, None)?,
            original,
            program,
            expressions: Vec::new(),
            stop: Stop::default(),
            interrupt: Arc::default(),
        };
        debugger.go_to_first_cycle()?;
        Ok(debugger)
    }

    /// Makes the searches of the debugger end where they are while the number, which other threads change, is not 0.
    pub fn interrupt_by(&mut self, requests: Arc<AtomicUsize>) {
        self.interrupt = requests;
    }

    /// Returns whether a search is to end where it is.
    #[must_use]
    pub fn is_interrupted(&self) -> bool {
        self.interrupt.load(Ordering::Relaxed) > 0
    }

    /// Returns the program that is debugged.
    #[must_use]
    pub fn program(&self) -> &RecordedProgram {
        &self.program
    }

    /// Returns the compiled program, with the sources to which all places refer.
    #[must_use]
    pub fn compiled(&self) -> &Compiled {
        &self.replay.compiled
    }

    /// Returns the flows of all commands.
    #[must_use]
    pub fn tables(&self) -> &[FlowTable] {
        &self.replay.tables
    }

    /// Returns the values at the present position.
    #[must_use]
    pub fn stop(&self) -> &Stop {
        &self.stop
    }

    /// Returns the length of a tick in ns.
    #[must_use]
    pub fn tick_ns(&self) -> u64 {
        self.original.tick_ns
    }

    /// Returns the indices of the flows of an expression in the table of a command: one for each scalar part of its value, in each call
    /// of the node that has it.
    pub fn flows_of(&self, id: ExpressionId, table: usize) -> impl Iterator<Item = usize> + '_ {
        let name = format!("{ADDED}{}", id.0);
        let flows = self.replay.tables.get(table).map_or(&[][..], |t| &t.flows);
        let is_whole = |path: &str| path.rsplit('.').next() == Some(&name);
        // The flows of a call have names inside of that of its result.
        let has_whole = flows.iter().any(|flow| is_whole(&flow.path));
        let flows = flows
            .iter()
            .enumerate()
            .filter(|(_, flow)| match has_whole {
                true => is_whole(&flow.path),
                false => added_name(&flow.path) == Some(&name),
            });
        let flows: Vec<usize> = flows.map(|(k, _)| k).collect();
        flows.into_iter()
    }

    /// Returns the indices of the flows that a command evaluates in the present cycle, in order.
    #[must_use]
    pub fn equations(&self, id: CommandId) -> Vec<usize> {
        let mut commands = self.stop.commands.iter();
        let Some(command) = commands.find(|command| command.id == id) else {
            return Vec::new();
        };
        let table = &self.replay.tables[command.table];
        let evaluated = table.flows.iter().enumerate().filter(|(k, flow)| {
            let is_present = command.values[*k].is_some();
            is_present && !Debugger::is_added(&flow.path) && !flow.span.is_none()
        });
        evaluated.map(|(k, _)| k).collect()
    }

    /// Returns whether a flow was added by the debugger.
    #[must_use]
    pub fn is_added(path: &str) -> bool {
        added_name(path).is_some()
    }

    /// Goes to a tick, or to the last one if there are fewer. Returns whether there is such a tick.
    ///
    /// # Errors
    /// Returns an error if the recording is damaged, or differs from its replay.
    pub fn go_to(&mut self, tick: u64) -> Result<bool, DebugError> {
        self.replay.timeline.seek(tick)?;
        if self.capture()? {
            return Ok(true);
        }
        let end = self.replay.timeline.now();
        self.replay.timeline.seek(end.saturating_sub(1))?;
        self.capture()?;
        Ok(false)
    }

    /// Replays forwards from the present position until a breakpoint is reached. Returns the breakpoints there; none at
    /// the end of the recording, whose last tick is then the position.
    ///
    /// # Errors
    /// Returns an error if the recording is damaged, or differs from its replay.
    pub fn run_forwards(&mut self, breakpoints: &[Breakpoint]) -> Result<Vec<Hit>, DebugError> {
        let next = self.stop.tick + 1;
        let mut found = None;
        self.scan((next, u64::MAX), breakpoints, &mut |tick, hits| {
            found = Some((tick, hits.to_vec()));
            ControlFlow::Break(())
        })?;
        match found {
            Some((tick, hits)) => self.go_to(tick).map(|_| hits),
            None => {
                let last = self.replay.timeline.now().saturating_sub(1);
                self.go_to(last).map(|_| Vec::new())
            }
        }
    }

    /// Replays backwards from the present position until a breakpoint is reached. Returns the breakpoints there; none at
    /// the start of the recording, whose first cycle is then the position.
    ///
    /// # Errors
    /// Returns an error if the recording is damaged, or differs from its replay.
    pub fn run_backwards(&mut self, breakpoints: &[Breakpoint]) -> Result<Vec<Hit>, DebugError> {
        let (mut end, mut length) = (self.stop.tick, FIRST_SEARCH);
        while end > 0 {
            if self.is_interrupted() {
                return self.go_to(end).map(|_| Vec::new());
            }
            let start = end.saturating_sub(length);
            let mut last = None;
            self.scan((start, end), breakpoints, &mut |tick, hits| {
                last = Some((tick, hits.to_vec()));
                ControlFlow::Continue(())
            })?;
            if let Some((tick, hits)) = last {
                return self.go_to(tick).map(|_| hits);
            }
            (end, length) = (start, length * 2);
        }
        self.go_to_first_cycle()?;
        Ok(Vec::new())
    }

    /// Returns the last tick in which a command that runs now has a cycle.
    ///
    /// # Errors
    /// Returns an error if the recording is damaged, or differs from its replay.
    pub fn last_cycle(&mut self, id: CommandId) -> Result<u64, DebugError> {
        self.replay.timeline.seek(self.stop.tick)?;
        let (mut last, mut period) = (self.stop.tick, 1);
        while !self.is_interrupted() {
            let mut runs = false;
            let tick_ns = self.original.tick_ns;
            let stepped = self.replay.timeline.step(&mut |_, running, command| {
                if running == id {
                    runs = true;
                    period = command.instance().image().period_ns / tick_ns;
                }
            })?;
            self.check()?;
            match stepped {
                Some(tick) if runs => last = tick,
                Some(tick) if tick <= last + period => {}
                _ => break,
            }
        }
        Ok(last)
    }

    /// Passes each tick from the first one up to, but without, the second one, in which a breakpoint is reached, to `take`.
    fn scan(
        &mut self,
        (from, to): (u64, u64),
        breakpoints: &[Breakpoint],
        take: &mut dyn FnMut(u64, &[Hit]) -> ControlFlow<()>,
    ) -> Result<(), DebugError> {
        // The last cycle of each command before is replayed, too: an event is a difference from it.
        self.replay
            .timeline
            .seek(from.saturating_sub(self.longest_period))?;
        let mut watch = BreakpointWatch::new(breakpoints);
        let mut hits = Vec::new();
        while self.replay.timeline.now() < to && !self.is_interrupted() {
            hits.clear();
            let Replay {
                tables, timeline, ..
            } = &mut self.replay;
            let stepped = timeline.step(&mut |_, id, command| {
                if let Some(table) = table_of(tables, command) {
                    watch.observe((id, command.instance()), (table, &tables[table]), &mut hits);
                }
            })?;
            self.check()?;
            let Some(tick) = stepped else {
                break;
            };
            if tick >= from && !hits.is_empty() && take(tick, &hits).is_break() {
                break;
            }
        }
        Ok(())
    }

    /// Adds an expression of the language to the program, which is evaluated with the equations of a line, and replays the recording
    /// up to the present position.
    ///
    /// # Errors
    /// Returns an error, and keeps everything as it is, if the expression does not compile, if it changes the run (because it faults or
    /// uses the devices), or if it reads a sensor that was not recorded.
    pub fn add_expression(&mut self, line: u32, text: &str) -> Result<ExpressionId, DebugError> {
        let expression = Expression {
            line,
            text: text.to_owned(),
        };
        if let Some(known) = self.expressions.iter().position(|e| *e == expression) {
            return Ok(ExpressionId(known));
        }
        if self.expressions.len() >= MAX_EXPRESSIONS {
            return Err(DebugError::TooManyExpressions(MAX_EXPRESSIONS));
        }
        // Alone, so that the errors are those of this expression.
        let alone = self.text_with(std::slice::from_ref(&expression))?;
        self.program.check(alone, self.original.tick_ns)?;
        self.expressions.push(expression);
        let tick = self.stop.tick;
        match self.replay_with_expressions(tick) {
            Ok(replay) => self.replay = replay,
            Err(error) => {
                self.expressions.pop();
                return Err(error);
            }
        }
        self.capture()?;
        Ok(ExpressionId(self.expressions.len() - 1))
    }

    /// Prepares a replay with the expressions that is before a tick, and has replayed it once.
    fn replay_with_expressions(&mut self, tick: u64) -> Result<Replay, DebugError> {
        let text = self.text_with(&self.expressions)?;
        let mut replay = Replay::new(&self.original, &self.program, Some(text))?;
        replay.timeline.seek(tick + 1)?;
        if let Some(difference) = &replay.timeline.report().difference {
            let difference = difference.to_string();
            let place = difference.lines().next().unwrap_or_default();
            return Err(DebugError::ChangesRun(place.to_owned()));
        }
        let known = self.replay.timeline.unrecorded();
        let mut read = replay.timeline.unrecorded().into_iter();
        if let Some(sensor) = read.find(|sensor| !known.contains(sensor)) {
            return Err(DebugError::NotRecorded(sensor));
        }
        replay.timeline.seek(tick)?;
        Ok(replay)
    }

    /// Returns whether expressions are evaluated with the program.
    #[must_use]
    pub fn has_expressions(&self) -> bool {
        !self.expressions.is_empty()
    }

    /// Drops all expressions and goes to a tick.
    ///
    /// # Errors
    /// Returns an error if the recording is damaged, or differs from its replay.
    pub fn drop_expressions(&mut self, tick: u64) -> Result<(), DebugError> {
        self.expressions.clear();
        self.replay = Replay::new(&self.original, &self.program, None)?;
        self.go_to(tick).map(drop)
    }

    /// Returns the text of the program with an equation for each expression.
    fn text_with(&self, expressions: &[Expression]) -> Result<String, DebugError> {
        let mut text = self.program.text()?.to_owned();
        let dialect = Dialect::from_path(&self.program.path().to_string_lossy());
        for (k, expression) in expressions.iter().enumerate() {
            let line = expression.line;
            let at = insertion_point(&text, dialect, line).ok_or(DebugError::NoBody(line))?;
            // No line break, so that all lines keep their numbers.
            let one_line = expression.text.replace(['\n', '\r'], " ");
            text.insert_str(at, &format!(" {ADDED}{k} = ({one_line});"));
        }
        Ok(text)
    }

    fn go_to_first_cycle(&mut self) -> Result<(), DebugError> {
        self.replay.timeline.seek(0)?;
        while self.capture()? {
            if !self.stop.commands.is_empty() {
                return Ok(());
            }
        }
        Ok(())
    }

    /// Replays the next tick and keeps its values. Returns false at the end, where the values of the last tick are kept.
    fn capture(&mut self) -> Result<bool, DebugError> {
        let Replay {
            tables, timeline, ..
        } = &mut self.replay;
        let mut commands = Vec::new();
        let stepped = timeline.step(&mut |_, id, command| {
            if let Some(table) = table_of(tables, command) {
                let values = RunningCommand::new(id, command.instance(), (table, &tables[table]));
                commands.push(values);
            }
        })?;
        self.check()?;
        if let Some(tick) = stepped {
            self.stop = Stop { tick, commands };
        }
        Ok(stepped.is_some())
    }

    fn check(&self) -> Result<(), DebugError> {
        match &self.replay.timeline.report().difference {
            Some(difference) => Err(DebugError::Differs(difference.to_string())),
            None => Ok(()),
        }
    }
}

/// Returns the name of the flow that the debugger has added, in the path of such a flow or of a part of it.
fn added_name(path: &str) -> Option<&str> {
    path.split(['.', '[']).find(|name| name.starts_with(ADDED))
}

/// Returns the index of the table of a command; `None` for a command of another program.
fn table_of(tables: &[FlowTable], command: &Command) -> Option<usize> {
    let image = command.instance().image();
    tables.iter().position(|table| table.is_of(image))
}

impl Replay {
    /// Compiles a program, with `text` in place of its own, and prepares the replay of a recording with all its flows.
    fn new(
        original: &Recording,
        program: &RecordedProgram,
        text: Option<String>,
    ) -> Result<Replay, DebugError> {
        let mut recording = original.clone();
        let all = [ALL_FLOWS.to_owned()];
        let lower = rpi_driver::lower_for_observation_in_tick;
        let CompiledForReplay { compiled, images } =
            program.compile(&mut recording, (&all, text), lower)?;
        let tables = images.iter().map(|(net, image)| {
            let net = &compiled.nets()[*net];
            FlowTable::new(net, Arc::clone(image))
        });
        let tables = tables.collect();
        Ok(Replay {
            tables,
            compiled,
            timeline: ReplayTimeline::new(Arc::new(recording))?,
        })
    }
}
