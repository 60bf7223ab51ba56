"""Moving water: added mass, drag and current."""
