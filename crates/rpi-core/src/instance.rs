//! A running image: its memory and the phases of its cycle.

use crate::cycle_context::CycleContext;
use crate::load::{LoadError, verify_image};
use crate::ports::Ports;
use crate::program::{ExecutableStep, Program, copy_slots};
use crate::work_bound::WorkBound;
use rpi_device::{DeviceBank, Discontinuity};
use rpi_image::CommandFlow;
use rpi_image::image::{
    ActuatorPort, CommandEnd, CommandEndKind, Fragment, Image, Signal, SlotRange, TRUE,
};
use rpi_prims::{Context, CycleTime, Fault, FaultCode};

use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;

/// Way in which a command ends after a cycle.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Verdict {
    /// The command ends by one of its named results, given by its index in the image.
    Result(usize),
    /// The net set its port `terminate` to true; the number is the value of its port `fail`, 0 for no error.
    Terminate(i64),
    /// A fault in the cycle, such as an overflow or a missing sample.
    Fault(Fault),
}

/// Loaded instance of an image (a compiled command): its memory, its executable steps and its resolved device ports.
#[derive(Clone)]
pub struct Instance {
    image: Arc<Image>,
    slots: Box<[u64]>,
    steps: Program,
    commit: Program,
    /// For each fragment, the range of its initial values in [`Image::init`]; they are copied when the fragment
    /// restarts.
    init: Box<[SlotRange]>,
    work_bound: WorkBound,
    ports: Ports,
    cycle: u64,
    clock: CycleTime,
    fault: Option<Fault>,
}

impl Instance {
    /// Verifies an image, resolves its devices and allocates its memory.
    ///
    /// # Errors
    /// Returns every reason why the image cannot run in this cell.
    pub fn load(
        image: impl Into<Arc<Image>>,
        bank: &mut dyn DeviceBank,
    ) -> Result<Instance, Vec<LoadError>> {
        let image: Arc<Image> = image.into();
        verify_image(&image)?;
        let mut faults = Vec::new();
        let ports = Ports::load(&image, bank, &mut faults);
        if !faults.is_empty() {
            return Err(faults);
        }
        let mut machine = Instance {
            slots: vec![0; image.layout.end as usize].into(),
            steps: Program::new(&image, &image.steps),
            commit: Program::new(&image, &image.commit),
            init: image
                .fragments
                .iter()
                .map(|f| init_range(&image, f))
                .collect(),
            work_bound: WorkBound::for_image(&image),
            ports,
            cycle: 0,
            clock: CycleTime {
                dt: image.period_ns as f64 / 1e9,
                tick_ns: image.tick_ns,
                period_ticks: image.period_ns / image.tick_ns.max(1),
                cycle_index: 0,
                net_ns: 0,
                wall_ns: 0,
            },
            fault: None,
            image,
        };
        machine.reset();
        Ok(machine)
    }

    /// Restores the state that the instance had after loading: initial memory, cycle number 0, no fault.
    pub fn reset(&mut self) {
        self.slots.fill(0);
        for &(cell, bits) in &self.image.init {
            self.slots[cell as usize] = bits;
        }
        self.ports.reset();
        self.cycle = 0;
        self.fault = None;
    }

    /// Returns the image that this instance of a command was loaded from.
    #[must_use]
    pub fn image(&self) -> &Arc<Image> {
        &self.image
    }

    /// Returns the number of the current cycle, counted from 0; between two cycles, the number of the next one.
    #[must_use]
    pub fn cycle(&self) -> u64 {
        self.cycle
    }

    /// Returns the numbers of the resources (actuators) that the image needs, in ascending order.
    pub fn resources(&self) -> impl Iterator<Item = u32> + '_ {
        self.ports.held_resources()
    }

    /// Returns the memory of the instance without its image, in bytes: slots and resolved steps.
    #[must_use]
    pub fn memory(&self) -> usize {
        size_of_val(&*self.slots)
            + size_of_val(&*self.steps.ops)
            + size_of_val(&*self.steps.guards)
            + size_of_val(&*self.commit.ops)
            + size_of_val(&*self.commit.guards)
            + size_of_val(&*self.init)
    }

    /// Returns the memory of the instance together with its image, in bytes.
    #[must_use]
    pub fn footprint(&self) -> usize {
        self.memory() + self.image.memory_bytes()
    }

    /// Returns the first fault of the current cycle; `None` if the cycle has no fault.
    #[must_use]
    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// Phase 1 of a cycle: stores the values of the sensors and of the flows that the core provides, such as times and
    /// `cancel`.
    pub fn read(&mut self, bank: &mut dyn DeviceBank, context: &CycleContext) {
        self.clock = CycleTime {
            cycle_index: self.cycle,
            net_ns: context.net_ns,
            wall_ns: context.wall_ns,
            ..self.clock
        };
        let mut cx = prim_context(&mut self.slots, self.clock, bank, self.fault);
        self.ports.read_sensors(&self.image, &mut cx);
        self.fault = cx.fault;
        for flow in &self.image.flows {
            let bits = flow_bits(flow.kind, self.clock, context);
            self.slots[flow.value.start as usize] = bits.unwrap_or(0);
            if flow.value.present != TRUE {
                self.slots[flow.value.present as usize] = u64::from(bits.is_some());
            }
        }
    }

    /// Phase 2 of a cycle: runs every active primitive (basic operation) once, in dependency order.
    pub fn evaluate(&mut self, bank: &mut dyn DeviceBank) {
        let mut cx = prim_context(&mut self.slots, self.clock, bank, self.fault);
        let (image, init) = (&*self.image, &*self.init);
        let mut pc = 0;
        while pc < self.steps.ops.len() {
            pc = step(pc, &self.steps, image, init, &mut self.ports, &mut cx);
        }
        self.fault = cx.fault;
    }

    /// Runs the single step with index `pc` of phase 2, for tests and debuggers. Returns the index of the next step.
    pub fn step(&mut self, pc: usize, bank: &mut dyn DeviceBank) -> usize {
        if pc >= self.steps.ops.len() {
            return pc;
        }
        let mut cx = prim_context(&mut self.slots, self.clock, bank, self.fault);
        let (image, init) = (&*self.image, &*self.init);
        let next = step(pc, &self.steps, image, init, &mut self.ports, &mut cx);
        self.fault = cx.fault;
        next
    }

    /// Phase 3 of a cycle: stores the values that the delays (`pre`) return in the next cycle.
    pub fn commit(&mut self) {
        let mut pc = 0;
        while let Some(op) = self.commit.ops.get(pc) {
            pc = match *op {
                ExecutableStep::Copy { words } => {
                    copy_slots(&mut self.slots, &self.image.code[words.range()]);
                    pc + 1
                }
                ExecutableStep::Skip { guards, to } => {
                    self.commit.next_step(&self.slots, guards, to)
                }
                _ => pc + 1,
            };
        }
    }

    /// Phase 4 of a cycle: sends all set-points to the devices. After a fault, sends none and stops the moving
    /// actuators.
    ///
    /// Returns false if a moving actuator had no set-point and was stopped.
    pub fn hand_over(&mut self, bank: &mut dyn DeviceBank) -> bool {
        self.cycle += 1;
        if self.fault.is_some() {
            self.ports.stop(bank);
            return true;
        }
        self.ports.hand_over(bank)
    }

    /// Raises the fault for an actuator that moves without a set-point or whose set-point its device has rejected.
    pub(crate) fn fail_uncontrolled(&mut self) {
        let (code, actuator) = self.ports.uncontrolled_fault();
        let actuator = actuator.and_then(|k| self.image.actuators.get(k));
        self.fail(code, actuator.map_or(0, ActuatorPort::origin_slot));
    }

    /// Enables the continuity check for the first set-points after a takeover.
    pub(crate) fn enable_continuity_check(&mut self) {
        self.ports.checks_continuity = true;
    }

    /// Returns the actuator port whose set-point is discontinuous in this cycle; `None` if all are continuous.
    pub(crate) fn discontinuity(&self) -> Option<&ActuatorPort> {
        let (actuator, _) = self.ports.discontinuity?;
        self.image.actuators.get(actuator)
    }

    /// Returns the discontinuity of this cycle and removes it, so that it is reported once; `None` if there is none.
    pub(crate) fn take_discontinuity(&mut self) -> Option<Discontinuity> {
        self.ports.discontinuity.take().map(|(_, jump)| jump)
    }

    /// Raises a fault in this cycle, unless there is one already. `cell` is the memory slot of the flow to report.
    pub(crate) fn fail(&mut self, code: FaultCode, cell: u32) {
        self.fault.get_or_insert(Fault::new(code, cell));
    }

    /// Phase 5 of a cycle: returns how the command ends after this cycle; `None` if it continues. `covered` holds for
    /// each named result whether a successor takes over; a `yield` without a successor is ignored.
    #[must_use]
    pub fn verdict(&self, covered: &[bool]) -> Option<Verdict> {
        if let Some(fault) = self.fault {
            return Some(Verdict::Fault(fault));
        }
        match &self.image.end {
            CommandEnd::Results(results) => {
                let requested = |fail: bool| {
                    results.iter().enumerate().position(|(k, r)| {
                        let may = r.kind != CommandEndKind::Yield || covered.get(k) == Some(&true);
                        (r.kind == CommandEndKind::Fail) == fail && may && self.is_true(r.condition)
                    })
                };
                // A `fail` takes precedence over other results of the same cycle, wherever it is in the text.
                requested(true)
                    .or_else(|| requested(false))
                    .map(Verdict::Result)
            }
            CommandEnd::Ports { terminate, fail } => {
                let ends = terminate.is_some_and(|s| self.is_true(s));
                let error = fail
                    .and_then(|s| self.value(s))
                    .map_or(0, |v| v[0].cast_signed());
                ends.then_some(Verdict::Terminate(error))
            }
        }
    }

    /// Returns the value of a flow as 64-bit slots; `None` if it is absent. The flow must belong to an active fragment.
    #[must_use]
    pub fn value(&self, signal: Signal) -> Option<&[u64]> {
        let present = self
            .slots
            .get(signal.present as usize)
            .is_some_and(|&p| p != 0);
        self.slots.get(signal.slots().range()).filter(|_| present)
    }

    /// True if the fragment with this index and all fragments around it were active in this cycle.
    #[must_use]
    pub fn is_active(&self, fragment: u32) -> bool {
        let mut at = Some(fragment);
        while let Some(f) = at.and_then(|k| self.image.fragments.get(k as usize)) {
            if self.slots.get(f.active as usize).is_none_or(|&a| a == 0) {
                return false;
            }
            at = f.parent;
        }
        true
    }

    /// Returns an upper bound of the work per cycle, in elementary operations (a real addition is 1). `primitives` is a
    /// known bound for all primitives together; without it, all fragments count as active.
    #[must_use]
    pub fn work(&self, primitives: Option<u64>) -> u64 {
        let known = primitives
            .unwrap_or(u64::MAX)
            .min(self.work_bound.primitives);
        known.saturating_add(self.work_bound.overhead)
    }

    /// Returns the index of the fragment, among those active in this cycle, whose own steps have the most work. The
    /// work of nested fragments counts for them alone. 0 if no candidate is active.
    #[must_use]
    pub fn heaviest_active_fragment(&self) -> u32 {
        let mut heaviest = self.work_bound.heaviest.iter().copied();
        heaviest.find(|f| self.is_active(*f)).unwrap_or(0)
    }

    /// Overwrites a flow with the slots `value`, or makes it absent with `None`. Tests and replays inject values this
    /// way.
    ///
    /// Returns false if the number of slots differs or the flow cannot be absent.
    pub fn force(&mut self, signal: Signal, value: Option<&[u64]>) -> bool {
        if let Some(value) = value {
            let cells = self.slots.get_mut(signal.slots().range());
            let Some(cells) = cells.filter(|c| c.len() == value.len()) else {
                return false;
            };
            cells.copy_from_slice(value);
        }
        let external = signal.present > TRUE;
        match self.slots.get_mut(signal.present as usize) {
            Some(present) if external => *present = u64::from(value.is_some()),
            _ => return value.is_some(),
        }
        true
    }

    /// Sets the input with index `index` between two cycles. `value` holds its 64-bit slots; `net_ns` is the logical
    /// time of the update in nanoseconds. Returns false if there is no such input or the number of slots is wrong.
    pub fn set_input(&mut self, index: usize, value: &[u64], net_ns: i64) -> bool {
        let Some(input) = self.image.inputs.get(index) else {
            return false;
        };
        let (target, updated) = (input.value, input.last_updated);
        let is_set = self.force(target, Some(value));
        if let Some(updated) = updated.filter(|_| is_set) {
            self.force(updated, Some(&[net_ns.cast_unsigned()]));
        }
        is_set
    }

    /// Marks the input with index `index` as never set. An input that may be absent becomes absent.
    pub fn clear_input(&mut self, index: usize) {
        let input = self.image.inputs.get(index);
        if let Some(updated) = input.and_then(|input| input.last_updated) {
            self.force(updated, None);
        }
    }

    fn is_true(&self, signal: Signal) -> bool {
        self.value(signal).is_some_and(|v| v[0] != 0)
    }
}

fn prim_context<'a>(
    cells: &'a mut [u64],
    clock: CycleTime,
    devices: &'a mut dyn DeviceBank,
    fault: Option<Fault>,
) -> Context<'a> {
    Context {
        slots: cells,
        time: clock,
        devices,
        fault,
    }
}

/// Runs the step with index `pc` of an image and returns the index of the next one.
#[inline(always)]
fn step(
    pc: usize,
    steps: &Program,
    image: &Image,
    init: &[SlotRange],
    ports: &mut Ports,
    cx: &mut Context<'_>,
) -> usize {
    match steps.ops[pc] {
        ExecutableStep::Run { code, words } => code(cx, &image.code[words.range()]),
        ExecutableStep::Copy { words } => copy_slots(cx.slots, &image.code[words.range()]),
        ExecutableStep::Skip { guards, to } => return steps.next_step(cx.slots, guards, to),
        ExecutableStep::Reset { unless, fragment } if cx.slots[unless as usize] == 0 => {
            let index = fragment as usize;
            let init = &image.init[init[index].range()];
            restore(cx.slots, image.fragments[index].state, init);
        }
        ExecutableStep::Reset { .. } => {}
        ExecutableStep::Actuate { actuator } => ports.actuate(image, actuator as usize, cx),
        ExecutableStep::Call { function } => ports.call(image, function as usize, cx),
    }
    pc + 1
}

fn restore(cells: &mut [u64], state: SlotRange, init: &[(u32, u64)]) {
    cells[state.range()].fill(0);
    for &(cell, bits) in init {
        cells[cell as usize] = bits;
    }
}

/// Returns the range of those entries in the image's list of initial values that belong to the state of a fragment.
fn init_range(image: &Image, fragment: &Fragment) -> SlotRange {
    let before = |cell: u32| image.init.partition_point(|i| i.0 < cell);
    let (start, end) = (before(fragment.state.start), before(fragment.state.end()));
    // There are fewer than 2^32 slots, and fewer initial values than slots.
    SlotRange {
        start: start as u32,
        len: (end - start) as u32,
    }
}

/// Returns the number of ticks since the first cycle.
fn elapsed_ticks(clock: CycleTime) -> i64 {
    clock
        .cycle_index
        .saturating_mul(clock.period_ticks)
        .cast_signed()
}

fn flow_bits(flow: CommandFlow, clock: CycleTime, context: &CycleContext) -> Option<u64> {
    Some(match flow {
        CommandFlow::Cancel => u64::from(context.cancel),
        CommandFlow::Takeover => u64::from(context.takeover),
        CommandFlow::Time => clock.seconds(elapsed_ticks(clock)).to_bits(),
        CommandFlow::Elapsed => elapsed_ticks(clock).cast_unsigned(),
        CommandFlow::PeriodTicks => clock.period_ticks,
        CommandFlow::Period => clock.dt.to_bits(),
        CommandFlow::NetTime => clock.net_ns.cast_unsigned(),
        CommandFlow::WallTime => clock.wall_ns.cast_unsigned(),
        CommandFlow::SpeedOverride => context.controls.speed_override.to_bits(),
        CommandFlow::Pause => u64::from(context.controls.paused),
        CommandFlow::Predecessor => return context.predecessor.map(i64::cast_unsigned),
    })
}
