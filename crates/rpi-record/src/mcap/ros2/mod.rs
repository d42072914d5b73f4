//! ROS 2 messages: their definitions, their encoding in CDR, and the messages of topics with flows or ports.

pub(super) mod cdr;
pub(super) mod definitions;
pub(super) mod topic_message;
