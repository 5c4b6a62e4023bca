"""Brokers as transports of a fleet: `nats` with the logs of `stream`, and `kafka` with `cluster` and the logs of `partition`.

`shared` is how a fleet is begun and its lanes are claimed on any of them, `numbered` which messages of a log count.
"""
