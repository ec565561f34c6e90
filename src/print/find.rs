//! Printers on the network, by what they tell of themselves (DNS-SD: RFC 6763, over multicast, RFC 6762).

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use mdns_sd::{ResolvedService, ServiceDaemon, ServiceEvent};

use super::address::Address;

/// A printer that was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// Its name.
    pub name: String,
    /// Where it is.
    pub address: Address,
    /// Media types.
    pub formats: Vec<String>,
    /// Where it stands.
    pub note: String,
}

/// Most printers that are listed.
const MOST: usize = 1000;

/// Listens for so long.
///
/// # Errors
/// The network cannot be listened to.
pub fn find(time: Duration) -> Result<Vec<Found>, String> {
    const SERVICE: &str = "_ipp._tcp.local.";
    let daemon = ServiceDaemon::new().map_err(|error| format!("the network cannot be listened to: {error}"))?;
    let events = daemon.browse(SERVICE).map_err(|error| format!("the network cannot be listened to: {error}"))?;
    let deadline = Instant::now() + time;
    let mut all = BTreeMap::new();
    while let Ok(event) = events.recv_deadline(deadline) {
        match event {
            ServiceEvent::ServiceResolved(service) if all.len() < MOST => {
                all.insert(service.get_fullname().to_owned(), service);
            }
            ServiceEvent::ServiceRemoved(_, name) => drop(all.remove(&name)),
            _ => {}
        }
    }
    // It ends with its threads, or with the process.
    let _ = daemon.shutdown();
    Ok(all.values().filter_map(|service| of(service)).collect())
}

fn of(service: &ResolvedService) -> Option<Found> {
    let text = |key: &str| service.get_property_val_str(key).unwrap_or_default().to_owned();
    let name = service.get_fullname().split("._ipp._tcp").next().unwrap_or_default().replace("\\ ", " ");
    // Not every system resolves names that end in .local: an address of IPv4 is good everywhere.
    let host = service
        .get_addresses_v4()
        .into_iter()
        .min()
        .map_or_else(|| service.get_hostname().trim_end_matches('.').to_owned(), |ip| ip.to_string());
    let path = text("rp");
    let address = Address::parse(&format!("ipp://{host}:{}/{}", service.get_port(), path.trim_start_matches('/'))).ok()?;
    let formats = text("pdl").split(',').map(|format| format.trim().to_owned()).filter(|format| !format.is_empty()).collect();
    Some(Found { name, address, formats, note: text("note") })
}

/// Addresses at which a host's printers are looked for.
///
/// # Errors
/// It is no name of a host.
pub fn probes(host: &str) -> Result<Vec<Address>, String> {
    if host.contains("://") {
        return Address::parse(host).map(|address| vec![address]);
    }
    let host = if host.parse::<std::net::Ipv6Addr>().is_ok() { format!("[{host}]") } else { host.to_owned() };
    ["/ipp/print", "/ipp", "/ipp/printer", "/"].into_iter().map(|path| Address::parse(&format!("ipp://{host}{path}"))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probes_of_a_host() {
        let first = |host: &str| probes(host).map(|all| all[0].to_string());
        assert_eq!(first("10.0.0.7").as_deref(), Ok("ipp://10.0.0.7/ipp/print"));
        assert_eq!(first("fe80::1").as_deref(), Ok("ipp://[fe80::1]/ipp/print"));
        assert_eq!(first("host:8631").as_deref(), Ok("ipp://host:8631/ipp/print"));
        assert_eq!(first("ipp://host/x").as_deref(), Ok("ipp://host/x"));
        assert!(first("a b").is_err());
    }
}
