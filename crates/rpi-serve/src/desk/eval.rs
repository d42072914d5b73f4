//! Evaluation of a net for one cycle and its exports. Clients use it to read sensors and to compute kinematics.

use rpi_runtime::control::{State, Why};

use super::owed::Debt;
use super::watch::texts;
use super::{Desk, Failure, Language, Load, Phase, Reply, Then};

/// Callback for the exports after one cycle: key and value.
pub(crate) type Take = Box<dyn FnOnce(Vec<(String, String)>) + Send>;

/// A client that waits for the single cycle.
pub(crate) struct Eval {
    /// Callback for the error, if the cycle does not take place.
    pub(super) reply: Reply,
    take: Take,
}

/// Session number of evaluations, which belong to no session.
const NOBODY: u64 = 0;

impl Desk {
    /// Runs a net for one cycle. It must not need an actuator that another command holds.
    pub(crate) fn eval(&mut self, text: &str, take: Take, reply: Reply) {
        let load = Load {
            session: "",
            title: "eval",
            language: Language::Rpinet,
            text,
            command: None,
            period_ns: 0,
            on_overrun: None,
        };
        let eval = Eval { reply, take };
        let nobody: Reply = Box::new(|_| ());
        self.load_for(NOBODY, &load, Some(eval), nobody);
    }

    /// Reports the exports of evaluations that have run, and unloads their commands.
    pub(super) fn finish_evals(&mut self) {
        let evals = self.commands.iter().filter(|(_, r)| r.eval.is_some());
        let over: Vec<u64> = evals
            .filter(|(_, r)| {
                let ran = r.board.as_ref().is_some_and(|b| b.cycles() > 0);
                ran || matches!(r.status.phase, Phase::Is(State::Terminated))
            })
            .map(|(number, _)| *number)
            .collect();
        over.into_iter().for_each(|number| self.finish_eval(number));
    }

    fn finish_eval(&mut self, number: u64) {
        let Some(record) = self.commands.get_mut(&number) else {
            return;
        };
        let cells = record.board.as_ref().and_then(|b| b.read());
        let exports = record.image.as_ref().map_or(&[][..], |i| &i.exports);
        let values = cells.map(|cells| texts(exports, &cells));
        record.unload_at_end = true;
        if let Some(eval) = record.eval.take() {
            match values {
                Some(values) => (eval.take)(values),
                None => (eval.reply)(Err(Failure::Bad("the net did not run".to_owned()))),
            }
        }
        self.owe(number, Debt::Abort(Why::Request));
        self.owe(number, Debt::Unload);
    }

    /// Starts the command of an evaluation. During an emergency stop only a command without actuators is started.
    pub(super) fn start_eval(&mut self, number: u64) {
        let Some(record) = self.commands.get(&number) else {
            return;
        };
        let moves = record
            .image
            .as_ref()
            .is_some_and(|i| !i.actuators.is_empty());
        let started = match self.may_start() {
            Err(why) if moves => Err(why),
            _ => record.id.map_or(Err(Failure::Busy), |id| {
                self.control.start(id).map_err(Failure::from)
            }),
        };
        match started {
            Ok(ticket) => drop(self.asked(Ok(ticket), Then::Eval(number), None)),
            Err(why) => self.give_up_eval(number, why),
        }
    }

    /// Reports that the cycle does not take place, and unloads the command.
    pub(super) fn give_up_eval(&mut self, number: u64, why: Failure) {
        let record = self.commands.get_mut(&number);
        if let Some(eval) = record.and_then(|r| r.eval.take()) {
            (eval.reply)(Err(why));
        }
        self.owe(number, Debt::Unload);
    }
}
