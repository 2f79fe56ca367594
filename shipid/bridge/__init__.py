"""The bridge: a live page of the ship, her planned track and her predicted one; it steers nothing but its simulator."""
