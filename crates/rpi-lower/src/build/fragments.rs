//! Lowering of fragments: scopes that are skipped as a whole, and their restarts.

use super::Builder;
use crate::flat_net::{ScopeId, index};
use crate::registers::{Region, Register};
use rpi_image::image::{self, SlotRange};
use rpi_net::{AbsentPolicy, Activation, FragmentId, PortRef, Restart};

impl Builder<'_> {
    /// Adds one table entry per fragment of the net. The activation is filled in when the fragment is built.
    pub(super) fn fragments_table(&mut self) {
        for id in self.net.fragment_ids() {
            let fragment = self.net.fragment(id);
            let parent = fragment.parent;
            self.flat.tables.fragments.push(image::Fragment {
                path: parent.map_or(String::new(), |p| self.net.path(p, &fragment.name)),
                parent: parent.map(|p| p.0),
                active: Register::TRUE.0,
                state: SlotRange::default(),
            });
        }
    }

    pub(super) fn fragment(&mut self, id: FragmentId) {
        let net = self.net;
        let fragment = net.fragment(id);
        let Some(parent) = fragment.parent else {
            return;
        };
        let is_again = self.entry_counts[id.index()] > 0;
        let active = match is_again {
            true => self.active[id.index()],
            false => self.activity(id, parent),
        };
        self.active[id.index()] = active;
        self.flat.tables.fragments[id.index()].active = active.0;
        if active == Register::TRUE && fragment.restart == Restart::Never {
            self.scope[id.index()] = self.scope[parent.index()];
            return self.items(id);
        }
        let scope = self.flat.open(self.scope[parent.index()], active);
        self.scope[id.index()] = scope;
        // The schedule may enter a fragment several times in a cycle; only the first entry may reset it.
        if !is_again {
            self.restart(id, parent, scope);
        }
        self.items(id);
        self.flat.close(scope);
    }

    /// The Boolean that activates a fragment, computed in the scope of its parent.
    fn activity(&mut self, id: FragmentId, parent: FragmentId) -> Register {
        let net = self.net;
        let Activation::When {
            condition,
            if_absent: absent,
        } = net.fragment(id).activation
        else {
            return Register::TRUE;
        };
        let flow = self.seen_from(condition, parent).flow;
        let scope = self.scope[parent.index()];
        match absent {
            AbsentPolicy::Inactive => {
                self.logic
                    .and(&mut self.flat, scope, flow.value, flow.present)
            }
            AbsentPolicy::Active => {
                let missing = self.logic.not(&mut self.flat, scope, flow.present);
                self.logic.or(&mut self.flat, scope, flow.value, missing)
            }
        }
    }

    fn restart(&mut self, id: FragmentId, parent: FragmentId, scope: ScopeId) {
        let unless = match self.net.fragment(id).restart {
            Restart::Never => return,
            Restart::OnActivation => self.was_active(id, parent),
            Restart::Every(condition) => self.restart_not_requested(condition, parent, scope),
        };
        self.flat.scopes[scope.index()].reset = Some((unless, index(id.index())));
    }

    /// True if the fragment was active when its parent last was. It is part of the parent's state, so that a pause of
    /// the parent does not end the activation of the child.
    fn was_active(&mut self, id: FragmentId, parent: FragmentId) -> Register {
        let was = self.flat.registers.add(Region::State(parent), 1);
        let active = self.active[id.index()];
        let outer = self.scope[parent.index()];
        self.flat.scopes[outer.index()].latches.push((active, was));
        was
    }

    /// Negated restart condition; an absent condition counts as false.
    fn restart_not_requested(
        &mut self,
        condition: PortRef,
        parent: FragmentId,
        scope: ScopeId,
    ) -> Register {
        let flow = self.seen_from(condition, parent).flow;
        let outer = self.flat.scopes[scope.index()]
            .parent
            .unwrap_or(ScopeId::ROOT);
        let asked = self
            .logic
            .and(&mut self.flat, outer, flow.value, flow.present);
        self.logic.not(&mut self.flat, outer, asked)
    }

    /// Adds the latches of all delays.
    pub(super) fn latches(&mut self) {
        for (id, kept) in std::mem::take(&mut self.delays) {
            let link = self.link(id, 0);
            let scope = self.scope_of(id);
            let latches = &mut self.flat.scopes[scope.index()].latches;
            latches.push((link.flow.value, kept.value));
            if kept.present != Register::TRUE {
                latches.push((link.flow.present, kept.present));
            }
        }
    }
}
