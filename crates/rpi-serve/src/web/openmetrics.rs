//! Values of one moment as OpenMetrics metrics.

use std::fmt;

use prometheus_client::collector::Collector;
use prometheus_client::encoding::{DescriptorEncoder, EncodeMetric, MetricEncoder, NoLabelSet};
use prometheus_client::metrics::MetricType;
use prometheus_client::metrics::counter::ConstCounter;
use prometheus_client::metrics::gauge::ConstGauge;
use prometheus_client::registry::Registry;
use rpi_runtime::realtime::{BUCKET_BOUNDS_NS, DurationHistogram};

/// Number of events since the start of the server.
#[derive(Clone, Copy, Debug)]
pub(super) struct Counter(pub(super) u64);

/// Number that may grow and shrink.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gauge(pub(super) u64);

/// Histogram of durations.
#[derive(Clone, Debug)]
pub(super) struct Histogram {
    /// Upper bound of each bucket in seconds, with the number of durations in it.
    buckets: Vec<(f64, u64)>,
    /// Sum of the durations in seconds.
    sum: f64,
}

/// Metrics of the same name that differ by the value of a label.
#[derive(Clone, Debug)]
pub(super) struct Family<M> {
    label: &'static str,
    metrics: Vec<(&'static str, M)>,
}

/// A metric with its name and description, as the registry collects it.
#[derive(Debug)]
struct Named<M> {
    name: &'static str,
    help: &'static str,
    metric: M,
}

/// A metric that can be shown on the page.
pub(super) trait Register:
    EncodeMetric + fmt::Debug + Send + Sync + Sized + 'static
{
    /// Adds the metric to a registry. `help` describes it without a full stop, which the format adds.
    fn register(self, registry: &mut Registry, name: &'static str, help: &'static str) {
        let metric = self;
        registry.register_collector(Box::new(Named { name, help, metric }));
    }
}

impl<M: EncodeMetric + fmt::Debug + Send + Sync + 'static> Register for M {}

impl<M: Register> Collector for Named<M> {
    fn encode(&self, mut encoder: DescriptorEncoder) -> fmt::Result {
        let help = format!("{}.", self.help);
        let kind = self.metric.metric_type();
        let encoder = encoder.encode_descriptor(self.name, &help, None, kind)?;
        self.metric.encode(encoder)
    }
}

impl EncodeMetric for Counter {
    fn encode(&self, encoder: MetricEncoder) -> fmt::Result {
        ConstCounter::new(self.0).encode(encoder)
    }

    fn metric_type(&self) -> MetricType {
        MetricType::Counter
    }
}

impl EncodeMetric for Gauge {
    fn encode(&self, encoder: MetricEncoder) -> fmt::Result {
        ConstGauge::new(self.0).encode(encoder)
    }

    fn metric_type(&self) -> MetricType {
        MetricType::Gauge
    }
}

/// Converts a duration to seconds.
fn seconds(ns: u64) -> f64 {
    ns as f64 / 1e9
}

impl From<&DurationHistogram> for Histogram {
    fn from(durations: &DurationHistogram) -> Histogram {
        let bounds = BUCKET_BOUNDS_NS.into_iter().map(seconds);
        Histogram {
            buckets: bounds
                .chain([f64::INFINITY])
                .zip(durations.counts())
                .collect(),
            sum: seconds(durations.sum_ns()),
        }
    }
}

impl EncodeMetric for Histogram {
    fn encode(&self, mut encoder: MetricEncoder) -> fmt::Result {
        let count = self.buckets.iter().map(|(_, count)| count).sum();
        encoder.encode_histogram::<NoLabelSet>(self.sum, count, &self.buckets, None)
    }

    fn metric_type(&self) -> MetricType {
        MetricType::Histogram
    }
}

impl<M> Family<M> {
    /// Creates a family from the values of a label and the metric of each.
    pub(super) fn new(
        label: &'static str,
        metrics: impl IntoIterator<Item = (&'static str, M)>,
    ) -> Family<M> {
        Family {
            label,
            metrics: metrics.into_iter().collect(),
        }
    }
}

impl<M: EncodeMetric> EncodeMetric for Family<M> {
    fn encode(&self, mut encoder: MetricEncoder) -> fmt::Result {
        for (value, metric) in &self.metrics {
            let labels = [(self.label, *value)];
            metric.encode(encoder.encode_family(&labels)?)?;
        }
        Ok(())
    }

    fn metric_type(&self) -> MetricType {
        let first = self.metrics.first();
        first.map_or(MetricType::Unknown, |(_, metric)| metric.metric_type())
    }
}
