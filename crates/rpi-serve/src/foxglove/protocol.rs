//! Messages of the protocol.

use rpi_record::mcap::LiveTopic;
use serde_json::{Value, json};

/// Name of the protocol in the handshake of the websocket.
pub(super) const SUBPROTOCOL: &str = "foxglove.websocket.v1";

/// Number of the binary message with the data of a message.
const MESSAGE_DATA: u8 = 1;

/// Severity of a status message.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum StatusLevel {
    Warning = 1,
    Error = 2,
}

/// Request of a client.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum ClientRequest {
    /// Subscribe to channels: pairs of the number of the subscription, which the client chooses, and the number of the channel.
    Subscribe(Vec<(u32, u64)>),
    /// End the subscriptions with these numbers.
    Unsubscribe(Vec<u32>),
}

impl ClientRequest {
    /// Parses a message of a client. Returns the reason if the message is not supported.
    pub(super) fn parse(text: &str) -> Result<ClientRequest, String> {
        let message: Value =
            serde_json::from_str(text).map_err(|why| format!("a message must be JSON: {why}"))?;
        let list = |key: &str| {
            let list = message[key].as_array();
            list.ok_or_else(|| format!("the message needs the list `{key}`"))
        };
        let id = |value: &Value| value.as_u64().and_then(|number| u32::try_from(number).ok());
        match message["op"].as_str() {
            Some("subscribe") => {
                let pair = |entry: &Value| Some((id(&entry["id"])?, entry["channelId"].as_u64()?));
                let pairs: Option<Vec<(u32, u64)>> =
                    list("subscriptions")?.iter().map(pair).collect();
                let pairs = pairs.ok_or("a subscription needs the numbers `id` and `channelId`")?;
                Ok(ClientRequest::Subscribe(pairs))
            }
            Some("unsubscribe") => {
                let ids: Option<Vec<u32>> = list("subscriptionIds")?.iter().map(id).collect();
                let ids = ids.ok_or("the numbers of subscriptions are whole and below 2^32")?;
                Ok(ClientRequest::Unsubscribe(ids))
            }
            Some(other) => Err(format!(
                "`{other}` is not supported: this server only sends"
            )),
            None => Err("a message needs the text `op`".to_owned()),
        }
    }
}

/// Returns the first message to a client. `session` is different for each start of the server.
pub(super) fn server_info(session: &str) -> String {
    let name = concat!("rpi ", env!("CARGO_PKG_VERSION"));
    json!({
        "op": "serverInfo", "name": name, "capabilities": [], "metadata": {}, "sessionId": session,
    })
    .to_string()
}

/// Returns the description of a channel in a message that advertises it.
pub(super) fn channel(number: u64, topic: &LiveTopic<'_>) -> Value {
    json!({
        "id": number, "topic": topic.name, "encoding": topic.encoding, "schemaName": topic.schema_name,
        "schema": topic.schema, "schemaEncoding": topic.schema_encoding,
    })
}

/// Returns the message that advertises these channels.
pub(super) fn advertise<'c>(channels: impl Iterator<Item = &'c Value>) -> String {
    let channels: Vec<&Value> = channels.collect();
    json!({ "op": "advertise", "channels": channels }).to_string()
}

/// Returns the message that a channel does not exist any more.
pub(super) fn unadvertise(number: u64) -> String {
    json!({ "op": "unadvertise", "channelIds": [number] }).to_string()
}

/// Returns a message that people read.
pub(super) fn status(level: StatusLevel, text: &str) -> String {
    json!({ "op": "status", "level": level as u8, "message": text }).to_string()
}

/// Returns the binary message with the data of a message. `time` is in nanoseconds since the Unix epoch.
pub(super) fn message_data(subscription: u32, time: u64, data: &[u8]) -> Vec<u8> {
    let mut frame = Vec::with_capacity(1 + 4 + 8 + data.len());
    frame.push(MESSAGE_DATA);
    frame.extend(subscription.to_le_bytes());
    frame.extend(time.to_le_bytes());
    frame.extend(data);
    frame
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_parsed_or_explained() {
        let parse = ClientRequest::parse;
        let subscribe =
            r#"{"op":"subscribe","subscriptions":[{"id":0,"channelId":3},{"id":7,"channelId":5}]}"#;
        assert_eq!(
            parse(subscribe),
            Ok(ClientRequest::Subscribe(vec![(0, 3), (7, 5)]))
        );
        let unsubscribe = r#"{"op":"unsubscribe","subscriptionIds":[0,7]}"#;
        assert_eq!(
            parse(unsubscribe),
            Ok(ClientRequest::Unsubscribe(vec![0, 7]))
        );
        for (text, part) in [
            ("", "must be JSON"),
            ("[]", "`op`"),
            (r#"{"op":"subscribe"}"#, "`subscriptions`"),
            (
                r#"{"op":"subscribe","subscriptions":[{"id":-1,"channelId":3}]}"#,
                "`id`",
            ),
            (
                r#"{"op":"unsubscribe","subscriptionIds":[4294967296]}"#,
                "2^32",
            ),
            (
                r#"{"op":"setParameters","parameters":[]}"#,
                "`setParameters` is not supported",
            ),
        ] {
            let why = parse(text).unwrap_err();
            assert!(why.contains(part), "{text}: {why}");
        }
    }

    #[test]
    fn data_has_its_subscription_and_time_before_it() {
        let frame = message_data(0x0403_0201, 5, b"{}");
        assert_eq!(frame, [1, 1, 2, 3, 4, 5, 0, 0, 0, 0, 0, 0, 0, b'{', b'}']);
    }
}
