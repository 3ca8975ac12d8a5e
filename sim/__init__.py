"""Simulation: the golden renderer, the exact reference, metrics and cosimulation."""
