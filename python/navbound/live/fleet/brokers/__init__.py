"""Brokers as transports of a fleet: `nats` and `kafka`, each with its logs; `shared` and `numbered` are what they have in common."""
