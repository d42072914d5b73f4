//! Activation and reset of fragments, and the state that depends on them.

use super::fragment_activations::FragmentActivation;
use super::translator::Translator;
use crate::net::{AbsentPolicy, Activation, FragmentId, PortRef, Restart};
use rpi_image::Scalar;

impl Translator<'_> {
    /// Adds the Lustre flows that say whether each fragment is active and whether its state is reset. Parents come
    /// first.
    pub(super) fn fragments(&mut self) {
        for id in self.net().fragment_ids() {
            let activity = self.activity(id);
            self.fragments.set(id, activity);
        }
    }

    fn activity(&mut self, id: FragmentId) -> FragmentActivation {
        let fragment = self.net().fragment(id);
        let Some(parent) = fragment.parent else {
            return FragmentActivation::default();
        };
        let outer = self.fragments.get(parent).clone();
        let path = self.net().path(parent, &fragment.name);
        let on = match fragment.activation {
            Activation::Always => outer.active.clone(),
            Activation::When {
                condition,
                if_absent: absent,
            } => {
                let holds = self.holds(parent, condition, absent);
                let all = outer.active.iter().cloned().chain([holds]);
                let all: Vec<String> = all.collect();
                Some(
                    self.node
                        .add_local(&format!("{path}_on"), "bool", &all.join(" and ")),
                )
            }
        };
        let own = self.reset_condition(id, parent, on.as_deref());
        let again = match (own, &outer.reset) {
            (None, again) => again.clone(),
            (Some(own), None) => Some(self.node.add_local(&format!("{path}_again"), "bool", &own)),
            (Some(own), Some(outer)) => {
                let either = format!("{own} or {outer}");
                Some(
                    self.node
                        .add_local(&format!("{path}_again"), "bool", &either),
                )
            }
        };
        FragmentActivation {
            active: on,
            reset: again,
        }
    }

    /// Returns the Lustre expression of a fragment's own reset condition, apart from that of `parent`; `None` if it has
    /// none. `on` is the expression that is true while the fragment is active (`None`: always).
    fn reset_condition(
        &mut self,
        id: FragmentId,
        parent: FragmentId,
        on: Option<&str>,
    ) -> Option<String> {
        let fragment = self.net().fragment(id);
        match fragment.restart {
            Restart::Never => None,
            // A cycle in which the enclosing fragment is inactive does not end the activation, so state is kept in
            // `parent`.
            Restart::OnActivation => on.map(|on| {
                let like = format!("{}_was", self.net().path(parent, &fragment.name));
                let was = self.add_state(parent, &like, "bool", "false", |_| on.to_owned());
                format!("({on} and not {was})")
            }),
            // A reset request while the fragment is inactive is ignored.
            Restart::Every(condition) => {
                let requested = self.holds(parent, condition, AbsentPolicy::Inactive);
                Some(match on {
                    Some(on) => format!("({on} and {requested})"),
                    None => requested,
                })
            }
        }
    }

    fn holds(&mut self, reader: FragmentId, condition: PortRef, absent: AbsentPolicy) -> String {
        let seen = self.seen_port(reader, condition, Scalar::Bool);
        seen.holds(absent)
    }

    /// Adds a state variable that changes only in the cycles in which the fragment is active. Returns the name of the
    /// flow with the value of the previous active cycle.
    ///
    /// `first` is the initial value; `next` returns the expression of the next value for the name of the flow. `like`
    /// is the base of the names.
    pub(super) fn add_state(
        &mut self,
        fragment: FragmentId,
        like: &str,
        ty: &str,
        first: &str,
        next: impl FnOnce(&str) -> String,
    ) -> String {
        let FragmentActivation {
            active: on,
            reset: again,
        } = self.fragments.get(fragment).clone();
        let before = self.node.declare_local(like, ty);
        let next = next(&before);
        let state = match on {
            Some(on) => format!("if {on} then {next} else {before}"),
            None => next,
        };
        let state = self.node.add_local(&format!("{like}_next"), ty, &state);
        let last = format!("{first} -> pre {state}");
        let value = match again {
            Some(again) => format!("if {again} then {first} else ({last})"),
            None => last,
        };
        self.node.add_equation(&before, &value);
        before
    }
}
