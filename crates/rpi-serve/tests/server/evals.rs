//! Nets that run for one cycle: emergency stop and limits apply to them, and they leave nothing behind.

use serde_json::json;

use crate::client::{open, post};
use crate::nets::{hold, swing};
use crate::rules::Owner;

const READ: &str = "{m=RobotArm::JointMonitor(Robot='arm',Axis='0'),\
    at=Core::DoubleNetcommOut(inValue=m.outCommandedPosition,Key='at')}";

/// During an emergency stop, a client may still read positions.
#[test]
fn nothing_moves_by_a_single_cycle_after_an_emergency_stop() {
    let server = open();
    let mut owner = Owner::new(&server);
    let eval = |net: &str| post(server.address(), "/eval", &format!("dionet={net}"));
    assert!(eval(&hold(0)).contains("key=\"out_1\">true"));
    owner.ask("emergency.stop", &json!({"by": "the test"}));
    let refused = eval(&hold(0));
    assert!(refused.starts_with("HTTP/1.1 400"), "{refused}");
    assert!(refused.contains("emergency stop by the test"), "{refused}");
    assert!(eval(READ).contains("key=\"outat\">0"), "{}", eval(READ));
    owner.ask("emergency.reset", &json!({}));
    assert!(eval(&hold(0)).starts_with("HTTP/1.1 200"));
}

/// More evaluations than the limit of commands fail one after the other, and each one is removed.
#[test]
fn what_cannot_have_its_cycle_is_told_so_and_forgotten() {
    let server = open();
    let mut owner = Owner::new(&server);
    let swing = owner.load(&swing(0, 1e9), "swing", "rpinet");
    owner.ask("command.start", &json!({"command": swing}));
    for _ in 0..300 {
        let refused = post(server.address(), "/eval", &format!("dionet={}", hold(0)));
        assert!(refused.starts_with("HTTP/1.1 400"), "{refused}");
        assert!(refused.contains("arm[0] is held by swing"), "{refused}");
    }
    let read = post(server.address(), "/eval", &format!("dionet={READ}"));
    assert!(read.starts_with("HTTP/1.1 200"), "{read}");
}
