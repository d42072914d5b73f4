use rpi_core::{CommandError, Condition, Fact};

use super::*;

const GRANTED: u64 = 100;

fn id(number: u64) -> CommandId {
    CommandId::from_number(number)
}

/// Creates an admission state with commands 1, 2, ... that have these bounds and actuators.
fn admission(demands: &[(u64, &[u32])]) -> Admission {
    let mut admission = Admission::new(Some(Budget {
        ns_per_operation: 1.0,
        granted_ns: GRANTED,
    }));
    for (number, (bound_ns, actuators)) in (1..).zip(demands) {
        let demand = CommandDemand {
            bound_ns: *bound_ns,
            actuators: (*actuators).into(),
            is_live: false,
            is_running: false,
            pending_starts: 0,
        };
        admission.demands.insert(id(number), demand);
    }
    admission
}

fn ask(admission: &mut Admission, ticket: u64, start: u64) -> Result<(), BudgetExceededError> {
    let cause = admission.admit_start(id(start))?;
    admission.request_sent(Ticket(ticket), cause);
    Ok(())
}

/// Adds the rule with this number.
fn make(admission: &mut Admission, number: u64, rule: &Rule) -> Result<(), BudgetExceededError> {
    let cause = admission.admit_rule(RuleId(number), rule)?;
    admission.request_sent(Ticket(number), cause);
    admission.handle_event(&answer(number, None));
    Ok(())
}

fn answer(ticket: u64, refused: Option<CommandError>) -> Event {
    Event::Answer {
        ticket: Ticket(ticket),
        tick: 0,
        refused,
    }
}

#[test]
fn those_of_one_actuator_take_turns_and_others_add_up() {
    let mut admission = admission(&[(60, &[0, 1]), (70, &[1, 2]), (30, &[]), (40, &[7])]);
    for (ticket, start) in [(1, 1), (2, 2), (3, 3)] {
        assert_eq!(ask(&mut admission, ticket, start), Ok(()));
    }
    let why = ask(&mut admission, 4, 4).unwrap_err();
    assert_eq!(
        (why.needed_ns, why.taken_ns, why.granted_ns),
        (40, 100, 100)
    );
}

#[test]
fn what_was_refused_or_is_over_makes_room() {
    let mut admission = admission(&[(60, &[]), (60, &[])]);
    ask(&mut admission, 1, 1).unwrap();
    assert!(
        ask(&mut admission, 2, 2).is_err(),
        "the first is on its cause"
    );
    admission.handle_event(&answer(1, Some(CommandError::Unknown)));
    ask(&mut admission, 3, 2).unwrap();
    admission.handle_event(&answer(3, None));
    assert!(ask(&mut admission, 4, 1).is_err(), "the second runs");
    let over = Notice::Orphaned {
        command: id(2),
        kept: true,
    };
    admission.handle_event(&Event::Notice(over));
    assert_eq!(ask(&mut admission, 5, 1), Ok(()));
}

#[test]
fn who_counts_already_is_not_refused() {
    let mut admission = admission(&[(90, &[])]);
    ask(&mut admission, 1, 1).unwrap();
    admission.budget = Some(Budget {
        ns_per_operation: 1.0,
        granted_ns: 10,
    });
    assert_eq!(ask(&mut admission, 2, 1), Ok(()));
}

/// S1, L6: each command of a chain has ended before the next one starts.
#[test]
fn a_chain_takes_no_more_than_the_most_expensive_of_it() {
    let mut admission = admission(&[(60, &[]), (90, &[]), (70, &[]), (20, &[])]);
    ask(&mut admission, 1, 1).unwrap();
    for next in [2, 3] {
        let rule = Rule::follow(id(next - 1)).start(id(next));
        assert_eq!(make(&mut admission, next, &rule), Ok(()));
    }
    let why = ask(&mut admission, 4, 4).unwrap_err();
    assert_eq!((why.needed_ns, why.taken_ns), (20, 90));
    // Once command 3 may also start in another cause, it counts in addition to the others.
    let rule = Rule::when(Condition::always()).start(id(3));
    assert!(make(&mut admission, 5, &rule).is_err());
}

/// A rule that fired keeps the order of its commands. A rule that was dropped implies no order.
#[test]
fn what_has_started_by_a_rule_is_after_those_before() {
    let over = |outcome| {
        let mut admission = admission(&[(60, &[]), (90, &[]), (10, &[])]);
        ask(&mut admission, 1, 1).unwrap();
        let rule = Rule::follow(id(1)).start(id(2));
        make(&mut admission, 2, &rule).unwrap();
        admission.handle_event(&Event::Notice(Notice::Rule {
            rule: RuleId(2),
            outcome,
        }));
        ask(&mut admission, 3, 3)
    };
    assert!(over(RuleOutcome::Dropped).is_err());
    assert_eq!(over(RuleOutcome::Fired), Ok(()));
}

/// A command stopped by a rule excludes its successor only if it was running; otherwise it can be started again
/// later.
#[test]
fn who_is_stopped_is_before_only_if_it_runs_then() {
    let stopped = |fact, runs| {
        let mut admission = admission(&[(60, &[]), (90, &[])]);
        ask(&mut admission, 1, 1).unwrap();
        if runs {
            let (command, tick) = (id(1), 0);
            admission.handle_event(&Event::Notice(Notice::Started { command, tick }));
        }
        let rule = Rule::when(fact).stop(id(1)).start(id(2));
        make(&mut admission, 2, &rule).is_ok()
    };
    let export = || Condition::from_fact(id(1), Fact::Export(0));
    assert!(stopped(export(), false), "its export is of a cycle");
    assert!(stopped(Condition::always(), true));
    assert!(!stopped(Condition::always(), false));
}
#[test]
fn the_code_is_in_the_table_of_diagnostics() {
    assert_eq!(BudgetExceededError::CODE, rpi_diag::Code::RPI7003.as_str());
}
