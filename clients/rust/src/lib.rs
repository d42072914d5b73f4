//! Client of the control core (`rpi serve`), with an interface of goal, feedback, result and preempt as in ROS actions.
//!
//! ```no_run
//! use rpi_client::{Client, OnLoss, Program};
//!
//! let client = Client::connect("127.0.0.1:9000", None)?;
//! let session = client.open_session("demo", OnLoss::Cancel)?;
//! let goal = session.load(&Program::new("command Wait () let finish done when time >= 1[s]; tel"))?;
//! goal.start()?;
//! for feedback in goal.feedback() {
//!     println!("{} {:?}", feedback.state, feedback.values);
//! }
//! println!("{:?}", goal.result()?);
//! # Ok::<(), rpi_client::Error>(())
//! ```
//! [`Session::load_task`] does the same for a whole task of a program, and [`Client::emergency_stop`] stops everything.
//!
//! The client speaks JSON-RPC 2.0 over the server's websocket, on its own thread per connection. Calls block until they
//! are answered. This crate must not know how the server does anything.

mod connection;
mod device_info;
mod error;
mod goal;
mod identity;
mod task;
#[cfg(feature = "tls")]
mod tls;

pub use connection::Client;
pub use device_info::DeviceInfo;
pub use error::Error;
pub use goal::{Ending, Feedback, Goal, Language, OnLoss, Overruns, Program, Session};
pub use identity::Identity;
pub use task::{Step, Task, TaskEnd};
