//! Tests of the control core through its public interface: requests, events, samples, and freed objects.

mod support;
mod syscall_filter;

use std::sync::Arc;

use rpi_core::Command;
use rpi_device::NoDevices;
use rpi_runtime::control::{
    AbortReason, Cause, CommandError, CommandState, Event, ExportSnapshot, Fact, InputValue,
    Notice, RequestError, Rule,
};
use rpi_sim::{Cell, NamedDevice, SimBank};
use support::{TestCore, counter};

rpi_testkit::trap_allocations!();

#[test]
fn requests_can_name_what_has_not_arrived_yet() {
    let mut rig = TestCore::new(4);
    let a = rig.load(counter("A", 3));
    let b = rig.load(counter("B", 2));
    rig.control.schedule(Rule::follow(a).start(b)).unwrap();
    rig.control.start(a).unwrap();
    rig.ticks(10);
    let log = rig.log();
    let started = |id| move |e: &Event| matches!(e, Event::Notice(Notice::Started { command, .. }) if *command == id);
    assert!(log.iter().any(started(a)) && log.iter().any(started(b)));
    let (one, two) = (rig.control.get(a).unwrap(), rig.control.get(b).unwrap());
    assert_eq!(
        (one.state, two.state),
        (CommandState::Terminated, CommandState::Terminated)
    );
    // The takeover is immediate: the first cycle of B is in the tick after the last cycle of A.
    let cycles = one.ending.unwrap().cycles;
    assert_eq!(two.first_tick, one.first_tick.map(|t| t + cycles));
    assert_eq!(one.ending.unwrap().cause, Cause::Result(0));
}

#[test]
fn every_ticket_is_answered_once_and_in_order() {
    let mut rig = TestCore::new(4);
    let a = rig.load(counter("A", 1000));
    let tickets = [
        rig.control.cancel(a).unwrap(),
        rig.control.start(a).unwrap(),
        rig.control.start(a).unwrap(),
        rig.control.unload(a).unwrap(),
        rig.control.abort(a, AbortReason::ClientLost).unwrap(),
        rig.control.unload(a).unwrap(),
    ];
    rig.ticks(2);
    let answers: Vec<_> = rig
        .log()
        .into_iter()
        .filter_map(|e| match e {
            Event::Answer {
                ticket, refused, ..
            } if tickets.contains(&ticket) => Some((ticket, refused)),
            _ => None,
        })
        .collect();
    let refused = |state| Some(CommandError::InvalidState(state));
    let expected = [
        refused(CommandState::Ready),
        None,
        refused(CommandState::Running),
        refused(CommandState::Running),
        None,
        None,
    ];
    assert_eq!(
        answers,
        tickets.into_iter().zip(expected).collect::<Vec<_>>()
    );
    assert!(rig.control.get(a).is_none(), "it is freed");
}

#[test]
fn places_come_back_and_the_table_has_its_size() {
    let mut rig = TestCore::new(2);
    for _ in 0..20 {
        let a = rig.load(counter("A", 1));
        let b = rig.load(counter("B", 1));
        assert_eq!(
            rig.control.load(counter("C", 1)),
            Err(RequestError::TableFull)
        );
        // Nothing starts A. When the rule is withdrawn, nothing can start B any more, so B is unloaded automatically.
        let (rule, _) = rig.control.schedule(Rule::follow(a).start(b)).unwrap();
        rig.control.withdraw(rule).unwrap();
        rig.control.unload(a).unwrap();
        rig.ticks(1);
        let freed = rig
            .log()
            .iter()
            .filter(|e| matches!(e, Event::Freed(_)))
            .count();
        assert_eq!(freed, 2);
    }
}

#[test]
fn a_flood_is_held_back_and_carried_out_piece_by_piece() {
    let mut rig = TestCore::new(2);
    let a = rig.load(counter("A", 1_000_000));
    rig.control.start(a).unwrap();
    let mut accepted = 0;
    while rig.control.cancel(a).is_ok() {
        accepted += 1;
    }
    assert_eq!(rig.control.cancel(a), Err(RequestError::QueueFull));
    let mut answered = 0;
    for _ in 0..1000 {
        rig.ticks(1);
        let now = rig
            .log()
            .iter()
            .filter(|e| matches!(e, Event::Answer { .. }))
            .count();
        assert!(now <= rig.options.requests_per_tick);
        answered += now;
    }
    assert_eq!(answered, accepted + 2);
}

/// M1.3, M10.5: inputs set by the host reach the command, and its exports reach the host.
#[test]
fn inputs_and_exports_go_through() {
    let mut rig = TestCore::new(2);
    let a = rig.load(counter("A", 1_000_000));
    rig.control.start(a).unwrap();
    rig.control.subscribe(a, &[0], 1).unwrap();
    let step = |value: f64| InputValue {
        command: a,
        input: 0,
        value: [value.to_bits()].into(),
    };
    rig.ticks(2);
    rig.control.set(vec![step(10.0)]).unwrap();
    rig.ticks(2);
    let mut seen = Vec::new();
    rig.control.samples(|id, export, tick, value| {
        assert_eq!((id, export), (a, 0));
        seen.push((tick, value.map(|v| f64::from_bits(v[0]))));
    });
    assert_eq!(
        seen,
        [
            (0, Some(1.0)),
            (1, Some(2.0)),
            (2, Some(12.0)),
            (3, Some(22.0))
        ]
    );
    let bad = InputValue {
        command: a,
        input: 9,
        value: [0].into(),
    };
    assert_eq!(
        rig.control.set(vec![bad]),
        Err(RequestError::ValueSize {
            command: a,
            input: 9
        })
    );
    assert_eq!(rig.control.fact(a, "done"), Some(Fact::Result(0)));
    assert_eq!(rig.control.fact(a, "late"), Some(Fact::Export(1)));
    assert_eq!(rig.control.fact(a, "count"), None, "it is no Boolean");
}

#[test]
fn a_board_has_what_a_command_exports_in_its_latest_cycle() {
    let mut rig = TestCore::new(2);
    let image = counter("A", 1_000_000);
    let command = Command::load(Arc::clone(&image), &mut NoDevices).unwrap();
    let adopted = rig.control.adopt_with_snapshot(Box::new(command)).unwrap();
    assert_eq!(
        (
            adopted.snapshot.cycles(),
            adopted.snapshot.read_consistent()
        ),
        (0, None)
    );
    rig.control.start(adopted.id).unwrap();
    rig.ticks(7);
    let cells = adopted.snapshot.read_consistent().unwrap();
    let values = ExportSnapshot::values(&image.exports, &cells);
    let values: Vec<_> = values
        .map(|(export, value)| (export.key.as_str(), value.map(|v| v[0])))
        .collect();
    assert_eq!(values, [("count", Some(7f64.to_bits())), ("late", Some(0))]);
    assert_eq!(adopted.snapshot.cycles(), 7);
    // Another command gets the slot of A later. The snapshot of A must keep its values.
    rig.control.abort(adopted.id, AbortReason::Request).unwrap();
    rig.control.unload(adopted.id).unwrap();
    rig.ticks(1);
    rig.log();
    let other = rig.load(counter("B", 1_000_000));
    rig.control.start(other).unwrap();
    rig.ticks(3);
    assert_eq!(adopted.snapshot.read_consistent(), Some(cells));
}

#[test]
fn devices_come_and_go_and_are_freed_by_the_host() {
    let mut rig = TestCore::new(1);
    let cell = "[devices.io]\nkind = \"digital-io\"\ninputs = 1\noutputs = 1\n";
    let cell = Cell::parse("cell.toml", cell).unwrap_or_else(|e| panic!("{e}"));
    *rig.executive.plant() = SimBank::empty(2, 1e-3);
    for device in [true, false] {
        let part = device.then(|| NamedDevice::new(&cell.devices[0], 1e-3, 0, 1));
        let ticket = rig.control.replace_device(1, part).unwrap();
        rig.ticks(1);
        let answered = rig
            .log()
            .into_iter()
            .any(|e| matches!(e, Event::Answer { ticket: t, refused: None, .. } if t == ticket));
        assert!(answered);
        let places: Vec<_> = rig.executive.plant().status().map(|s| s.index).collect();
        assert_eq!(places, if device { vec![1] } else { vec![] });
    }
}

#[test]
fn an_emergency_stop_ends_everything() {
    let mut rig = TestCore::new(4);
    let a = rig.load(counter("A", 1_000_000));
    let b = rig.load(counter("B", 1));
    rig.control
        .schedule(Rule::follow(a).start(b).keep_orphans())
        .unwrap();
    rig.control.start(a).unwrap();
    rig.control.emergency_stop().unwrap();
    rig.ticks(1);
    rig.log();
    let ending = rig.control.get(a).unwrap().ending.unwrap();
    assert_eq!(ending.cause, Cause::Aborted(AbortReason::EmergencyStop));
    assert_eq!(rig.control.get(b).unwrap().state, CommandState::Ready);
}

/// After all commands were stopped, pending start requests must not start a command.
#[test]
fn a_tick_alone_takes_no_request() {
    let mut rig = TestCore::new(4);
    let id = rig.load(counter("late", 5));
    rig.ticks(1);
    rig.log();
    rig.control.start(id).unwrap();
    rig.executive.halt(AbortReason::EmergencyStop);
    rpi_testkit::no_alloc(|| (0..3).for_each(|_| rig.executive.tick_without_requests(0, &mut ())));
    let started = |event: &Event| matches!(event, Event::Notice(Notice::Started { command, .. }) if *command == id);
    assert!(!rig.log().iter().any(started));
    rig.ticks(1);
    assert!(rig.log().iter().any(started));
}
