//! Takeovers: the successor starts without a gap, and nothing moves without a command or a stop in control.

mod support;

use rpi_core::{
    AbortReason, Cause, Command, CommandError, CommandId, CommandState, Continuity, Core, Notice,
};
use rpi_net::{Net, ResultKind};
use rpi_prims::FaultCode;
use support::{
    Axes, MS, ROOT, core, follow, leaper, load, load_for, mover, mover_flow, over, ticks,
};

rpi_testkit::trap_allocations!();

/// Differences of consecutive set-points in mm, rounded.
fn steps(bank: &Axes, axis: u32) -> Vec<i64> {
    let points = bank.set_points(axis);
    points
        .windows(2)
        .map(|w| ((w[1] - w[0]) * 1e3).round() as i64)
        .collect()
}

#[test]
fn a_command_runs_to_its_end() {
    let mut bank = Axes::new();
    let (mut core, ids) = core(&[mover(0, 5, 100)], &mut bank);
    core.start(ids[0], &mut bank).unwrap();
    ticks(&mut core, &mut bank, 10);
    let command = core.command(ids[0]).unwrap();
    assert_eq!(command.state(), CommandState::Terminated);
    assert_eq!(command.result(), Some("done"));
    let ending = command.ending().unwrap();
    assert_eq!(
        (ending.error, ending.cycles, ending.left_moving),
        (0, 6, false)
    );
    assert_eq!(steps(&bank, 0), [1, 1, 1, 1, 0]);
}

/// Fig. 5 (a): scheduled in time, the predecessor yields in motion and the successor continues in the next tick. (M1.4,
/// M10.2, M11.2)
#[test]
fn a_successor_takes_over_in_motion() {
    let mut bank = Axes::new();
    let (mut core, ids) = core(&[mover(0, 9, 4), mover(0, 5, 100)], &mut bank);
    core.start(ids[0], &mut bank).unwrap();
    follow(&mut core, ids[1], ids[0], true, &mut bank).unwrap();
    ticks(&mut core, &mut bank, 12);
    assert_eq!(core.command(ids[0]).unwrap().result(), Some("early"));
    assert_eq!(core.command(ids[1]).unwrap().result(), Some("done"));
    assert_eq!(steps(&bank, 0), [1, 1, 1, 1, 1, 1, 1, 1, 0]);
    assert_eq!(bank.stops, [0; 4]);
}

/// The last set-point of a command holds for its whole period. The device gets the successor's period when the
/// successor starts. (S5)
#[test]
fn a_successor_of_a_shorter_period_begins_when_its_predecessor_would_go_on() {
    let mut bank = Axes::new();
    let mut core = Core::with_capacity(4, MS);
    let mut insert = |period, net: Net| {
        let mut command = load_for(period, &net, &mut bank);
        // These test axes ignore periods, so the velocity appears to change.
        command.set_continuity(Continuity::Allow);
        core.insert(command).map_err(|e| e.1).expect("room")
    };
    let ids = [
        insert(5 * MS, mover(0, 20, 7)),
        insert(MS, mover(0, 3, 100)),
    ];
    core.start(ids[0], &mut bank).unwrap();
    follow(&mut core, ids[1], ids[0], true, &mut bank).unwrap();
    let mut paces = Vec::new();
    for _ in 0..12 {
        ticks(&mut core, &mut bank, 1);
        paces.push((bank.paces[0], bank.set_points(0).len()));
    }
    // Two set-points with a period of five ticks, then one in every tick.
    let first = [(5, 1); 5].into_iter().chain([(5, 2); 5]);
    assert_eq!(paces, first.chain([(1, 3), (1, 4)]).collect::<Vec<_>>());
}

/// Fig. 5 (b): scheduled too late, the regular end comes first, and the successor starts right after it. (M10.2)
#[test]
fn without_a_successor_a_yield_is_passed_over() {
    let mut bank = Axes::new();
    let (mut core, ids) = core(&[mover(0, 6, 3), mover(0, 2, 100)], &mut bank);
    core.start(ids[0], &mut bank).unwrap();
    ticks(&mut core, &mut bank, 7);
    assert_eq!(core.command(ids[0]).unwrap().result(), Some("done"));
    let late = follow(&mut core, ids[1], ids[0], true, &mut bank);
    assert_eq!(late, Ok(()));
    assert_eq!(core.command(ids[1]).unwrap().state(), CommandState::Running);
    ticks(&mut core, &mut bank, 4);
    assert_eq!(steps(&bank, 0), [1, 1, 1, 1, 1, 0, 1, 1, 0]);
}

/// R2: a command gets all its resources or none, and a rejected one stays ready.
#[test]
fn a_refused_start_leaves_it_ready_and_names_the_holder() {
    let mut bank = Axes::new();
    let (mut core, ids) = core(&[mover(0, 5, 100), mover(0, 2, 100)], &mut bank);
    core.start(ids[0], &mut bank).unwrap();
    let refused = core.start(ids[1], &mut bank);
    let held = CommandError::ResourceHeld {
        resource: 0,
        by: ids[0],
    };
    assert_eq!(refused, Err(held));
    assert_eq!(core.command(ids[1]).unwrap().state(), CommandState::Ready);
    assert_eq!(core.command(ids[1]).unwrap().held().count(), 0);
    ticks(&mut core, &mut bank, 8);
    assert_eq!(core.start(ids[1], &mut bank), Ok(()));
}

/// A successor that does not take the moving axis does not enable a `yield`.
#[test]
fn a_yield_needs_a_successor_that_takes_what_moves() {
    let mut bank = Axes::new();
    let (mut core, ids) = core(&[mover(0, 6, 3), mover(1, 2, 100)], &mut bank);
    core.start(ids[0], &mut bank).unwrap();
    follow(&mut core, ids[1], ids[0], true, &mut bank).unwrap();
    ticks(&mut core, &mut bank, 10);
    assert_eq!(core.command(ids[0]).unwrap().result(), Some("done"));
    assert_eq!(core.command(ids[1]).unwrap().result(), Some("done"));
    assert_eq!(bank.stops, [0; 4]);
}

#[test]
fn resources_are_exclusive_and_inherited() {
    let mut bank = Axes::new();
    let nets = [
        mover(0, 5, 100),
        mover(0, 5, 100),
        mover(1, 5, 100),
        mover(1, 5, 100),
    ];
    let (mut core, ids) = core(&nets, &mut bank);
    core.start(ids[0], &mut bank).unwrap();
    let held = Err(CommandError::ResourceHeld {
        resource: 0,
        by: ids[0],
    });
    assert_eq!(core.start(ids[1], &mut bank), held);
    follow(&mut core, ids[1], ids[0], true, &mut bank).unwrap();
    // A scheduled command takes its free resources at once.
    follow(&mut core, ids[2], ids[1], true, &mut bank).unwrap();
    let held = Err(CommandError::ResourceHeld {
        resource: 1,
        by: ids[2],
    });
    assert_eq!(core.start(ids[3], &mut bank), held);
    assert_eq!(follow(&mut core, ids[3], ids[0], true, &mut bank), held);
    core.unschedule(ids[2]).unwrap();
    core.start(ids[3], &mut bank).unwrap();
    ticks(&mut core, &mut bank, 14);
    assert!(
        ids[..2]
            .iter()
            .all(|id| core.command(*id).unwrap().result() == Some("done"))
    );
}

/// A chain is built from its end, before it is known that earlier commands can run. All commands wait and run one after
/// the other without a gap. Unloading one in the middle orphans all commands after it.
#[test]
fn a_chain_can_be_made_from_its_end() {
    const LINKS: usize = 150;
    for broken in [None, Some(70)] {
        let mut bank = Axes::new();
        let mut core = Core::with_capacity(LINKS, MS);
        let insert = |core: &mut Core, bank: &mut Axes| core.insert(load(&mover(0, 2, 100), bank));
        let ids: Vec<CommandId> = (0..LINKS)
            .map(|_| insert(&mut core, &mut bank).map_err(|e| e.1).unwrap())
            .collect();
        for link in ids.windows(2).rev() {
            follow(&mut core, link[1], link[0], true, &mut bank).unwrap();
        }
        broken
            .into_iter()
            .for_each(|k: usize| drop(core.remove(ids[k]).unwrap()));
        let waits =
            |k: usize| core.command(ids[k]).map(|c| c.state()) == Some(CommandState::Scheduled);
        let last = broken.unwrap_or(LINKS) - 1;
        assert!((1..LINKS).all(|k| waits(k) == (k <= last)));
        core.start(ids[0], &mut bank).unwrap();
        ticks(&mut core, &mut bank, 3 * LINKS as u64);
        assert_eq!(steps(&bank, 0)[..6], [1, 0, 1, 1, 0, 1]);
        assert_eq!(bank.set_points(0).len(), 3 * (last + 1));
    }
}

#[test]
fn who_waits_for_a_failed_or_cancelled_command_is_not_started() {
    let failing = || {
        let mut b = rpi_bench::NetBuilder::new("Failing");
        let count = mover_flow(&mut b, 0, 1.0);
        let late = over(&mut b, count, 2.5);
        let never = over(&mut b, count, 1e6);
        b.result("never", ResultKind::Fail, never);
        b.result("broken", ResultKind::Fail, late);
        b.net
    };
    for kept in [true, false] {
        let mut bank = Axes::new();
        let (mut core, ids) = core(&[failing(), mover(0, 5, 100), mover(0, 5, 100)], &mut bank);
        core.start(ids[0], &mut bank).unwrap();
        follow(&mut core, ids[1], ids[0], kept, &mut bank).unwrap();
        follow(&mut core, ids[2], ids[1], kept, &mut bank).unwrap();
        ticks(&mut core, &mut bank, 5);
        let ending = *core.command(ids[0]).unwrap().ending().unwrap();
        assert_eq!(
            (ending.cause, ending.error, ending.left_moving),
            (Cause::Result(1), 2, true)
        );
        assert_eq!(bank.stops[0], 1);
        let state = core.command(ids[1]).map(|c| c.state());
        assert_eq!(state, kept.then_some(CommandState::Ready));
        assert_eq!(core.take_orphan().is_some(), !kept);
        assert_eq!(core.take_orphan().is_some(), !kept);
        assert!(core.take_orphan().is_none());
    }
}

/// M10.3.
#[test]
fn cancel_is_a_request_that_drops_the_successor() {
    let mut bank = Axes::new();
    let (mut core, ids) = core(&[mover(0, 5, 1), mover(0, 5, 100)], &mut bank);
    assert_eq!(
        core.cancel(ids[0]),
        Err(CommandError::InvalidState(CommandState::Ready))
    );
    core.start(ids[0], &mut bank).unwrap();
    follow(&mut core, ids[1], ids[0], true, &mut bank).unwrap();
    core.cancel(ids[0]).unwrap();
    assert_eq!(core.command(ids[1]).unwrap().state(), CommandState::Ready);
    ticks(&mut core, &mut bank, 3);
    assert_eq!(
        core.command(ids[0]).unwrap().state(),
        CommandState::Cancelling
    );
    core.abort(ids[0], AbortReason::Request, &mut bank).unwrap();
    let ending = *core.command(ids[0]).unwrap().ending().unwrap();
    assert_eq!(
        (ending.cause, ending.left_moving, bank.stops[0]),
        (Cause::Aborted(AbortReason::Request), true, 1)
    );
    core.start(ids[1], &mut bank).unwrap();
}

/// Two writers of one axis in a cycle: the second set-point is rejected, the command ends with a fault, and the axis
/// stops. (M9.4)
#[test]
fn concurrent_access_is_a_fault() {
    let mut bank = Axes::new();
    let mut b = rpi_bench::NetBuilder::new("Twice");
    mover_flow(&mut b, 0, 1.0);
    mover_flow(&mut b, 0, 2.0);
    let (mut core, ids) = core(&[b.net], &mut bank);
    core.start(ids[0], &mut bank).unwrap();
    ticks(&mut core, &mut bank, 2);
    let ending = *core.command(ids[0]).unwrap().ending().unwrap();
    let Cause::Fault(fault) = ending.cause else {
        panic!("{ending:?}");
    };
    assert_eq!(fault.code, FaultCode::ConcurrentAccess);
    assert_eq!((ending.error, bank.log.len()), (-1, 0));
    let image = core.command(ids[0]).unwrap().instance().image();
    assert_eq!(
        image.location_of(fault.slot).map(|p| p.path.as_str()),
        Some("n16")
    );
}

/// A failed device rejects set-points. An axis that moves without a set-point is stopped, and the command ends with a
/// fault. (M9.2)
#[test]
fn a_moving_axis_without_set_point_is_stopped() {
    let mut bank = Axes::new();
    let (mut core, ids) = core(&[mover(0, 50, 100)], &mut bank);
    core.start(ids[0], &mut bank).unwrap();
    ticks(&mut core, &mut bank, 3);
    bank.failed = true;
    ticks(&mut core, &mut bank, 2);
    let ending = *core.command(ids[0]).unwrap().ending().unwrap();
    let Cause::Fault(fault) = ending.cause else {
        panic!("{ending:?}");
    };
    assert_eq!(
        fault.code,
        FaultCode::DeviceFailed,
        "it was refused, not missing"
    );
    let image = core.command(ids[0]).unwrap().instance().image();
    assert!(image.location_of(fault.slot).is_some(), "{fault:?}");
    assert_eq!((bank.stops[0], ending.cycles), (1, 4));
}

#[test]
fn loading_tells_every_reason() {
    let mut bank = Axes::new();
    let mut b = rpi_bench::NetBuilder::new("Elsewhere");
    for axis in [7, 8] {
        mover_flow(&mut b, axis, 1.0);
    }
    let image =
        rpi_bench::image_compare::lower_net(&b.net, &rpi_lower::LowerOptions::running(support::MS));
    let faults = rpi_core::Command::load(image.unwrap(), &mut bank)
        .err()
        .unwrap();
    assert_eq!(faults.len(), 4, "{faults:?}");
    assert!(
        faults[0].to_string().contains("the index is out of range"),
        "{}",
        faults[0]
    );
}

#[test]
fn a_table_has_its_size_and_numbers_are_not_used_again() {
    let mut bank = Axes::new();
    let nets = [
        mover(0, 1, 9),
        mover(0, 1, 9),
        mover(0, 1, 9),
        mover(0, 1, 9),
    ];
    let (mut core, ids) = core(&nets, &mut bank);
    let (back, refused) = core.insert(load(&nets[0], &mut bank)).err().unwrap();
    assert_eq!(refused, CommandError::TableFull);
    core.remove(ids[2]).unwrap();
    let new = core.insert(back).map_err(|e| e.1).unwrap();
    assert!(!ids.contains(&new));
    assert!(core.command(ids[2]).is_none());
    assert_eq!(core.start(ids[2], &mut bank), Err(CommandError::Unknown));
    core.start(new, &mut bank).unwrap();
    assert_eq!(
        core.remove(new).err(),
        Some(CommandError::InvalidState(CommandState::Running))
    );
}

/// The smallest net has only the root fragment.
#[test]
fn an_empty_net_runs_for_ever() {
    let mut bank = Axes::new();
    let net = rpi_net::Net::new("empty");
    assert_eq!(net.fragments.len(), 1 + ROOT.index());
    let (mut core, ids) = core(&[net], &mut bank);
    core.start(ids[0], &mut bank).unwrap();
    ticks(&mut core, &mut bank, 100);
    assert_eq!(core.command(ids[0]).unwrap().state(), CommandState::Running);
}

/// State at the check of a takeover in motion: a mover on axis 1, and a leaper that takes over axis 0 with a
/// discontinuity from tick 4 on.
fn leap(guard: Continuity) -> (Axes, [Option<Cause>; 2], Vec<Notice>) {
    let mut bank = Axes::new();
    let nets = [mover(0, 9, 4), mover(1, 50, 100), leaper(0)];
    let (mut core, ids) = core(&nets, &mut bank);
    core.command_mut(ids[2]).unwrap().set_continuity(guard);
    core.start(ids[0], &mut bank).unwrap();
    core.start(ids[1], &mut bank).unwrap();
    follow(&mut core, ids[2], ids[0], true, &mut bank).unwrap();
    while core.next_notice().is_some() {}
    ticks(&mut core, &mut bank, 5);
    let cause = |c: &Command| c.ending().map(|e| e.cause);
    let causes = [ids[2], ids[1]].map(|id| cause(core.command(id).unwrap()));
    let jumps = std::iter::from_fn(|| core.next_notice());
    let jumps = jumps
        .filter(|n| matches!(n, Notice::Discontinuity { command, .. } if *command == ids[2]))
        .collect();
    (bank, causes, jumps)
}

/// J2: no set-point of the successor is sent, the device stops, and other commands continue.
#[test]
fn a_successor_that_jumps_is_refused() {
    let (bank, causes, jumps) = leap(Continuity::Reject);
    let Some(Cause::Fault(fault)) = causes[0] else {
        panic!("{causes:?}");
    };
    assert_eq!(fault.code, FaultCode::Discontinuity);
    assert_eq!((causes[1], jumps.len()), (None, 1));
    assert_eq!(steps(&bank, 0), [1, 1, 1]);
    assert_eq!(bank.stops, [1, 0, 0, 0]);
}

/// J3: all commands are stopped.
#[test]
fn a_jump_can_stop_everything() {
    let (bank, causes, jumps) = leap(Continuity::AbortAll);
    assert!(matches!(causes[0], Some(Cause::Fault(_))), "{causes:?}");
    assert_eq!(causes[1], Some(Cause::Aborted(AbortReason::Discontinuity)));
    assert_eq!((bank.stops, jumps.len()), ([1, 1, 0, 0], 1));
}

/// J4: the discontinuity is reported, and the device decides.
#[test]
fn a_jump_can_be_allowed() {
    let (bank, causes, jumps) = leap(Continuity::Allow);
    assert_eq!((causes, jumps.len()), ([None, None], 1));
    assert_eq!(steps(&bank, 0), [1, 1, 1, 500]);
}
