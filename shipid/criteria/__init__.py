"""Manoeuvring criteria of IMO MSC.137(76): a model evaluated, with its uncertainty."""
