//! Channels of a run, and the clients that have subscribed to them.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rpi_record::mcap::{LiveTopic, LiveViewers};
use serde_json::Value;

use super::client_queue::ClientQueue;
use super::protocol::{self, ClientRequest, StatusLevel};
use crate::transport::OutgoingMessage;

/// Channels of a run and their clients, shared by the recorder and the connections. Nothing is sent while it is locked.
#[derive(Clone, Default)]
pub(super) struct LiveHub(Arc<Mutex<HubState>>);

/// Number of a client.
pub(super) type ClientId = u64;

#[derive(Default)]
struct HubState {
    channels: BTreeMap<u64, Channel>,
    clients: BTreeMap<ClientId, LiveClient>,
    next_client: ClientId,
}

/// Channel with the messages of a topic.
struct Channel {
    /// Description of the channel for clients.
    description: Value,
    /// Whether new subscribers get the last message.
    is_latched: bool,
    /// Time and data of the last message of a latched channel.
    last: Option<(u64, Vec<u8>)>,
    subscribers: usize,
}

/// Client with its subscriptions.
#[derive(Default)]
struct LiveClient {
    queue: ClientQueue,
    /// Number of the subscription to each channel, by channel.
    subscriptions: BTreeMap<u64, u32>,
}

impl LiveHub {
    fn lock(&self) -> MutexGuard<'_, HubState> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Adds a client, which first gets `greeting` and the channels. Returns its number; `None` if there are `most` clients already.
    pub(super) fn add_client(&self, greeting: String, most: usize) -> Option<ClientId> {
        let mut state = self.lock();
        if state.clients.len() >= most {
            return None;
        }
        let mut client = LiveClient::default();
        client.queue.push_text(greeting);
        let channels = state.channels.values().map(|channel| &channel.description);
        client.queue.push_text(protocol::advertise(channels));
        let id = state.next_client;
        state.next_client += 1;
        state.clients.insert(id, client);
        Some(id)
    }

    /// Removes a client with its subscriptions.
    pub(super) fn remove_client(&self, id: ClientId) {
        let mut state = self.lock();
        let client = state.clients.remove(&id);
        let channels = client.into_iter().flat_map(|client| client.subscriptions);
        channels.for_each(|(channel, _)| state.release(channel));
    }

    /// Handles a message of a client. A message that is not supported is answered by a status message.
    pub(super) fn handle(&self, id: ClientId, text: &str) {
        let mut state = self.lock();
        match ClientRequest::parse(text) {
            Ok(ClientRequest::Subscribe(pairs)) => {
                let pairs = pairs.into_iter();
                pairs
                    .for_each(|(subscription, channel)| state.subscribe(id, subscription, channel));
            }
            Ok(ClientRequest::Unsubscribe(subscriptions)) => {
                let subscriptions = subscriptions.into_iter();
                subscriptions.for_each(|subscription| state.unsubscribe(id, subscription));
            }
            Err(why) => state.reject(id, &why),
        }
    }

    /// Takes the next message to a client.
    pub(super) fn next_message(&self, id: ClientId) -> Option<OutgoingMessage> {
        self.lock().clients.get_mut(&id)?.queue.pop()
    }

    /// Returns whether a client must be disconnected.
    pub(super) fn is_closed(&self, id: ClientId) -> bool {
        let state = self.lock();
        let client = state.clients.get(&id);
        client.is_none_or(|client| client.queue.is_closed())
    }
}

impl HubState {
    fn subscribe(&mut self, id: ClientId, subscription: u32, channel: u64) {
        let (Some(client), Some(known)) =
            (self.clients.get_mut(&id), self.channels.get_mut(&channel))
        else {
            return self.reject(id, &format!("there is no channel {channel}"));
        };
        let is_used = client
            .subscriptions
            .values()
            .any(|own| *own == subscription);
        if is_used || client.subscriptions.contains_key(&channel) {
            let why =
                format!("channel {channel} or subscription {subscription} is subscribed already");
            return self.reject(id, &why);
        }
        client.subscriptions.insert(channel, subscription);
        known.subscribers += 1;
        if let Some((time, data)) = &known.last {
            let frame = protocol::message_data(subscription, *time, data);
            client.queue.push_data(frame);
        }
    }

    fn unsubscribe(&mut self, id: ClientId, subscription: u32) {
        let Some(client) = self.clients.get_mut(&id) else {
            return;
        };
        let mut own = client.subscriptions.iter();
        let Some(channel) = own.find(|(_, own)| **own == subscription).map(|(c, _)| *c) else {
            return self.reject(id, &format!("there is no subscription {subscription}"));
        };
        client.subscriptions.remove(&channel);
        self.release(channel);
    }

    /// Counts one subscription to a channel less.
    fn release(&mut self, channel: u64) {
        if let Some(channel) = self.channels.get_mut(&channel) {
            channel.subscribers = channel.subscribers.saturating_sub(1);
        }
    }

    fn reject(&mut self, id: ClientId, why: &str) {
        if let Some(client) = self.clients.get_mut(&id) {
            client
                .queue
                .push_text(protocol::status(StatusLevel::Error, why));
        }
    }
}

impl LiveViewers for LiveHub {
    fn add_topic(&mut self, number: u64, topic: LiveTopic<'_>) {
        let description = protocol::channel(number, &topic);
        let text = protocol::advertise(std::iter::once(&description));
        let mut state = self.lock();
        let clients = state.clients.values_mut();
        clients.for_each(|client| client.queue.push_text(text.clone()));
        let channel = Channel {
            description,
            is_latched: topic.is_latched,
            last: None,
            subscribers: 0,
        };
        state.channels.insert(number, channel);
    }

    fn remove_topic(&mut self, number: u64) {
        let mut state = self.lock();
        state.channels.remove(&number);
        for client in state.clients.values_mut() {
            client.subscriptions.remove(&number);
            client.queue.push_text(protocol::unadvertise(number));
        }
    }

    fn needs(&self, number: u64) -> bool {
        let state = self.lock();
        let channel = state.channels.get(&number);
        channel.is_some_and(|channel| channel.is_latched || channel.subscribers > 0)
    }

    fn message(&mut self, number: u64, time: u64, data: &[u8]) {
        let mut state = self.lock();
        for client in state.clients.values_mut() {
            if let Some(subscription) = client.subscriptions.get(&number) {
                let frame = protocol::message_data(*subscription, time, data);
                client.queue.push_data(frame);
            }
        }
        let channel = state.channels.get_mut(&number);
        if let Some(channel) = channel.filter(|channel| channel.is_latched) {
            channel.last = Some((time, data.to_vec()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn topic(name: &str, is_latched: bool) -> LiveTopic<'_> {
        LiveTopic {
            name,
            encoding: "json",
            schema_name: "rpi.test",
            schema_encoding: "jsonschema",
            schema: "{}",
            is_latched,
        }
    }

    /// Returns the messages that wait for a client: texts, and data as text.
    fn waiting(hub: &LiveHub, id: ClientId) -> Vec<String> {
        std::iter::from_fn(|| hub.next_message(id))
            .map(|message| match message {
                OutgoingMessage::Text(text, _) => text,
                OutgoingMessage::Binary(data) => {
                    format!("{}:{}", data[1], String::from_utf8_lossy(&data[13..]))
                }
            })
            .collect()
    }

    fn subscribe(hub: &LiveHub, id: ClientId, pairs: &[(u32, u64)]) {
        let pairs: Vec<Value> = pairs
            .iter()
            .map(|(id, channel)| serde_json::json!({"id": id, "channelId": channel}))
            .collect();
        let message = serde_json::json!({"op": "subscribe", "subscriptions": pairs});
        hub.handle(id, &message.to_string());
    }

    #[test]
    fn messages_go_to_those_who_have_subscribed() {
        let mut hub = LiveHub::default();
        hub.add_topic(1, topic("/a", false));
        hub.add_topic(2, topic("/b", true));
        hub.message(2, 10, b"early");
        let [one, two] = [(); 2].map(|()| hub.add_client("hello".to_owned(), 2).unwrap());
        assert_eq!(hub.add_client(String::new(), 2), None, "there is no place");
        assert_eq!(waiting(&hub, one).len(), 2);
        assert!(!hub.needs(1) && hub.needs(2));
        subscribe(&hub, one, &[(5, 1), (6, 2)]);
        assert!(hub.needs(1));
        hub.message(1, 11, b"x");
        assert_eq!(waiting(&hub, one), ["6:early", "5:x"]);
        let texts = waiting(&hub, two);
        assert!(
            texts[0] == "hello" && texts[1].contains("\"/b\""),
            "{texts:?}"
        );
        hub.handle(one, r#"{"op":"unsubscribe","subscriptionIds":[5]}"#);
        assert!(!hub.needs(1));
        hub.remove_client(one);
        assert!(hub.is_closed(one) && !hub.is_closed(two));
    }

    #[test]
    fn a_removed_topic_ends_its_subscriptions() {
        let mut hub = LiveHub::default();
        let id = hub.add_client(String::new(), 1).unwrap();
        waiting(&hub, id);
        hub.add_topic(1, topic("/a", false));
        subscribe(&hub, id, &[(0, 1)]);
        hub.remove_topic(1);
        hub.message(1, 1, b"late");
        let texts = waiting(&hub, id);
        assert!(
            texts.len() == 2 && texts[1].contains("unadvertise"),
            "{texts:?}"
        );
        // Its number is free again.
        hub.add_topic(2, topic("/a", false));
        waiting(&hub, id);
        subscribe(&hub, id, &[(0, 2)]);
        hub.message(2, 1, b"y");
        assert_eq!(waiting(&hub, id), ["0:y"]);
    }

    #[test]
    fn wrong_subscriptions_are_reported() {
        let mut hub = LiveHub::default();
        hub.add_topic(1, topic("/a", false));
        hub.add_topic(2, topic("/b", false));
        let id = hub.add_client(String::new(), 1).unwrap();
        waiting(&hub, id);
        subscribe(&hub, id, &[(0, 1), (1, 1), (0, 2), (2, 9)]);
        hub.handle(id, r#"{"op":"unsubscribe","subscriptionIds":[4]}"#);
        hub.handle(id, "{");
        let texts = waiting(&hub, id);
        assert!(
            texts.len() == 5 && texts.iter().all(|text| text.contains("\"level\":2")),
            "{texts:?}"
        );
    }
}
